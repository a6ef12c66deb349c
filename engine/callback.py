"""Kernels that cannot be compiled: the engine calls them in Python, through the address of a C function.

The call takes Python's lock and costs about a microsecond beside the function itself.  An exception cannot cross the
compiled engine: it is kept, the kernel answers NaN from there on, and ``raise_kept`` raises it when the engine returns.
"""

import ctypes
import math
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_FLOATS = ctypes.POINTER(ctypes.c_double)
_PROTOTYPE = ctypes.CFUNCTYPE(None, ctypes.c_double, *[_FLOATS] * 5)
_kept = threading.local()  # of the run in each thread


class Callback:
    """A kernel called in Python: its ``address``, why (``reason``), how often and for how long [s] so far."""

    made = 0  # in this process

    def __init__(self, kernel: Any, reason: str) -> None:
        Callback.made += 1
        self.kernel, self.reason = kernel, reason
        self.calls, self.seconds = 0, 0.0
        self._function = _PROTOTYPE(self._call)  # must live as long as its address is used
        self.address = ctypes.cast(self._function, ctypes.c_void_p).value

    def _call(self, t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
        begin = time.perf_counter()
        self.calls += 1
        try:
            if getattr(_kept, "error", None) is None:
                self.kernel(t, x, d, u, p, out)
            else:
                out[0] = math.nan
        except BaseException as error:  # Ctrl-C too
            error.add_note(f"called by the engine at t = {t:.6g} s")
            _kept.error = error
            out[0] = math.nan
        self.seconds += time.perf_counter() - begin


@contextmanager
def pardoned() -> Iterator[None]:
    """Let kernels fail: an error leaves NaN and is forgotten; Ctrl-C is not."""
    yield
    error, _kept.error = getattr(_kept, "error", None), None
    if error is not None and not isinstance(error, Exception):
        raise error


def raise_kept() -> None:
    """Raise the exception that a kernel of this thread's run left behind, if there is one."""
    error, _kept.error = getattr(_kept, "error", None), None
    if error is not None:
        raise error
