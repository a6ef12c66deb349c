"""Compile the engine once per machine."""

from pathlib import Path

from numba import types
from numba.core.caching import FunctionCache
from stickslip.engine.advance import advance
from stickslip.engine.loading import ReadyCache
from stickslip.engine.notice import noticed
from stickslip.engine.stamp import fresh

_FLOATS, _ROWS = types.float64[::1], types.float64[:, ::1]
SIGNATURE = (types.int64[::1], _FLOATS, _ROWS, _FLOATS, _ROWS, types.float64, types.boolean)
_ready = False


def ensure_compiled() -> None:
    """Load or compile the engine once per process; processes that start together wait for the first one."""
    global _ready
    if _ready:
        return
    if isinstance(advance._cache, FunctionCache):  # not where nothing can be kept
        advance._cache = ReadyCache(advance.py_func)
    try:
        with fresh(Path(advance.stats.cache_path), Path(__file__).parent), noticed():
            advance.compile(SIGNATURE)
    except OSError:  # a cache that cannot be written is no reason not to run
        with noticed():
            advance.compile(SIGNATURE)
    _ready = True
