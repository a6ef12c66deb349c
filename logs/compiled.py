"""Numba's ``njit`` for every room, with a place for what it compiles.

Numba keeps compiled code beside the sources or in the home folder, and refuses at import where it can write neither.
It is then kept among temporary files: the place is chosen as this file is loaded, before anything is compiled.
"""

import os
import stat
import tempfile
from pathlib import Path

from numba import njit
from numba.core import config
from numba.core.caching import FunctionCache

__all__ = ["njit", "own_folder"]


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
