"""Numba's ``njit`` for every room, with a place for what it compiles, loaded without waking the compiler.

Numba keeps compiled code beside the sources or in the home folder, and refuses at import where it can write neither.
It is then kept among temporary files: the place is chosen as this file is loaded, before anything is compiled.

Before it loads anything numba reads in all that it would need to compile something: about a hundred modules, half of
what a short simulation costs.  Code that is ready needs numba's runtime only; what has to be compiled wakes the
compiler itself.
"""

import os
import stat
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numba
from numba.core import config
from numba.core.caching import FunctionCache
from numba.core.registry import CPUDispatcher
from numba.core.runtime import rtsys

__all__ = ["InnerFunction", "ReadyCache", "njit", "own_folder"]


class ReadyCache(FunctionCache):  # type: ignore[misc]
    """Numba's cache of one function, loading what is there as it is."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled function of a signature, or None if it is not there."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class InnerFunction(CPUDispatcher):  # type: ignore[misc]
    """A function that compiled code alone calls: it has no door for Python, of which numba keeps no check."""

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        """Raise ``TypeError``: without this Python would call what is not there."""
        raise TypeError(f"{self.py_func.__qualname__} is for compiled code only; Python may call its py_func")


def njit(function: Any = None, *, inner: bool = False, **options: Any) -> Any:
    """Return the function compiled as numba's ``njit`` does it; with ``cache`` what is kept is loaded as it is.

    ``inner``: compiled code alone calls it, so no door for Python is compiled, which costs more than a short function.
    """
    if function is None:
        return partial(njit, inner=inner, **options)
    cache = options.pop("cache", False)
    made = numba.njit(function, no_cpython_wrapper=inner, no_cfunc_wrapper=True, **options)
    if inner:
        made.__class__ = InnerFunction
    if cache:
        made._cache = ReadyCache(function)
    return made


def _choose() -> None:
    """Point numba to a folder of this user's for temporary files, if it has no other place beside our sources."""
    try:
        FunctionCache(_choose)
    except RuntimeError:  # numba's word for a file that has no place
        config.CACHE_DIR = str(own_folder(Path(tempfile.gettempdir())))


def own_folder(parent: Path) -> Path:
    """Return a folder in ``parent`` that nobody but this user can write; what is loaded from it will be run."""
    user = os.getuid() if hasattr(os, "getuid") else None
    folder = parent / ("stickslip" if user is None else f"stickslip-{user}")
    folder.mkdir(mode=0o700, exist_ok=True)
    facts = folder.lstat()
    safe = stat.S_ISDIR(facts.st_mode) and (user is None or (facts.st_uid == user and not facts.st_mode & 0o022))
    return folder if safe else Path(tempfile.mkdtemp(prefix="stickslip-", dir=parent))


_choose()
