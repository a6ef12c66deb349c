"""Builds ideal_loop.c with the machine's C compiler and calls it in process: the speed to compare with."""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cases.exact import IDEAL_HIGH, ExactLoop

SOURCE = Path(__file__).with_name("ideal_loop.c")
FLAGS = ("-O3", "-std=gnu11", "-shared", "-fPIC")
H_STUCK, H_SLIP = 0.05, 5e-4  # [s]
COLUMNS = ("t", "SP", "PV", "OP", "MV", "v")


class NoCompiler(RuntimeError):
    """No C compiler on this machine; install one, or set CC to its path."""


class Rows(NamedTuple):
    """Log of one run: `rows` of shape (n, 6) in the order of COLUMNS, and the number of stick and slip events."""

    rows: np.ndarray
    n_events: int

    @property
    def t(self) -> np.ndarray:
        return self.rows[:, 0]

    @property
    def e(self) -> np.ndarray:
        return self.rows[:, 1] - self.rows[:, 2]


@cache
def library() -> ctypes.CDLL:
    """The compiled library, built once per source and flags into the user's temporary directory."""
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        raise NoCompiler(f"no C compiler ({os.environ.get('CC', 'cc')!r} is not on PATH): the C peer is SKIPPED")
    key = hashlib.sha256(SOURCE.read_bytes() + " ".join((compiler, *FLAGS)).encode()).hexdigest()[:16]
    folder = Path(tempfile.gettempdir()) / f"stickslip-c-{os.getuid() if hasattr(os, 'getuid') else 'user'}"
    folder.mkdir(mode=0o700, exist_ok=True)
    target = folder / f"ideal_loop-{key}.so"
    if not target.exists():
        fresh = target.with_suffix(f".{os.getpid()}")  # renamed when complete: two builds cannot collide
        subprocess.run([compiler, *FLAGS, str(SOURCE), "-o", str(fresh), "-lm"], check=True, capture_output=True)
        fresh.replace(target)
    loaded = ctypes.CDLL(str(target))
    loaded.ideal_loop.restype = ctypes.c_int
    pointer, real = ctypes.c_void_p, ctypes.c_double
    loaded.ideal_loop.argtypes = [pointer, ctypes.c_int, real, real, real, pointer]
    return loaded


def prepare(loop: ExactLoop = IDEAL_HIGH, h_stuck: float = H_STUCK, h_slip: float = H_SLIP) -> Callable[[], Rows]:
    """A function of no arguments that does one run from rest into its own, re-used buffer: the thing to time.

    `h_stuck`, `h_slip` [s] are the RK4 steps. Raises NoCompiler, and ValueError for a loop that the C does not
    cover (integrating process, start away from rest).
    """
    if loop.integrating or loop.PV_0 or loop.z_0 or loop.x_0:
        raise ValueError(f"{loop!r}: the C peer covers the lag process from rest only; use cases.exact.exact_run")
    numbers = np.array(
        [getattr(loop, name) for name in ("K", "tau", "K_p", "T_i", "M", "k", "F_v", "F_c", "F_s", "SP")]
    )
    rows = np.zeros((round(loop.duration / loop.log_interval) + 1, len(COLUMNS)))
    call = library().ideal_loop
    arguments = (numbers.ctypes.data, rows.shape[0], loop.log_interval, h_stuck, h_slip, rows.ctypes.data)

    def once() -> Rows:
        return Rows(rows, call(*arguments))

    # ctypes sees addresses only; the closure must keep the arrays behind them alive.
    once.keeps = (numbers, rows)  # type: ignore[attr-defined]
    return once


def run(loop: ExactLoop = IDEAL_HIGH, h_stuck: float = H_STUCK, h_slip: float = H_SLIP) -> Rows:
    """One run of the C loop from rest; see `prepare`."""
    return prepare(loop, h_stuck, h_slip)()
