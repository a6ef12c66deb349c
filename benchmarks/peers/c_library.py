"""Builds a C program of this folder with the machine's C compiler and loads it: the speed to compare with."""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

FLAGS = ("-O3", "-std=gnu11", "-shared", "-fPIC")


class NoCompiler(RuntimeError):
    """No C compiler on this machine; install one, or set CC to its path."""


@cache
def library(name: str) -> ctypes.CDLL:
    """Return the compiled ``name``.c, built once per source and flags into the user's temporary directory.

    Raises NoCompiler.
    """
    source = Path(__file__).with_name(f"{name}.c")
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise NoCompiler(f"no C compiler ({os.environ.get('CC', 'cc')!r} is not on PATH): the C peer is SKIPPED")
    key = hashlib.sha256(source.read_bytes() + " ".join((compiler, *FLAGS)).encode()).hexdigest()[:16]
    folder = Path(tempfile.gettempdir()) / f"stickslip-c-{os.getuid() if hasattr(os, 'getuid') else 'user'}"
    folder.mkdir(mode=0o700, exist_ok=True)
    target = folder / f"{name}-{key}.so"
    if not target.exists():
        fresh = target.with_suffix(f".{os.getpid()}")  # renamed when complete: two builds cannot collide
        subprocess.run([compiler, *FLAGS, str(source), "-o", str(fresh), "-lm"], check=True, capture_output=True)
        fresh.replace(target)
    return ctypes.CDLL(str(target))
