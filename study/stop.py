"""Whether somebody asked a study to stop."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def stop_asked() -> Iterator[Callable[[], bool]]:
    """Yield a function that tells whether Ctrl-C was pressed.

    An ensemble ends quietly on Ctrl-C; if its variants were just finished, nothing of it is left to see.
    """
    asked = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield asked.is_set
        return
    handler: Callable[[int, FrameType | None], object] = before

    def note(number: int, frame: FrameType | None) -> None:
        asked.set()
        handler(number, frame)

    signal.signal(signal.SIGINT, note)
    try:
        yield asked.is_set
    finally:
        signal.signal(signal.SIGINT, before)
