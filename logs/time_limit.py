"""A limit of time on a block of code, so that one record or one run that never ends stops no other."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["time_limit"]


@contextmanager
def time_limit(seconds: float, message: str) -> Iterator[None]:
    """Raise TimeoutError with ``message`` in this block after ``seconds`` [s] > 0.

    Where the system has no alarms (Windows), and outside the main thread, there is no limit. Limits may be nested: the
    inner one leaves the outer one what is left of it.

    >>> with time_limit(0.01, "too slow"):
    ...     time.sleep(1.0)
    Traceback (most recent call last):
        ...
    TimeoutError: too slow
    """
    if not hasattr(signal, "SIGALRM") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def late(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(message)

    begun, before = time.monotonic(), signal.getsignal(signal.SIGALRM)
    left, _ = signal.getitimer(signal.ITIMER_REAL)
    outer_first = 0.0 < left < seconds
    signal.signal(signal.SIGALRM, before if outer_first else late)
    signal.setitimer(signal.ITIMER_REAL, left if outer_first else seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        if left > 0.0:
            signal.setitimer(signal.ITIMER_REAL, max(left - (time.monotonic() - begun), 1e-3))
