"""The ideal loop in C, called in process: the speed to compare with."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from stickslip.cases.exact import IDEAL_HIGH, ExactLoop

from benchmarks.peers.c_library import NoCompiler, library

__all__ = ["NoCompiler", "Rows", "prepare", "run"]

H_STUCK, H_SLIP = 0.05, 5e-4  # [s]
COLUMNS = ("t", "SP", "PV", "OP", "MV", "v")


class Rows(NamedTuple):
    """Log of one run: ``rows`` of shape (n, 6) in the order of COLUMNS, and the number of stick and slip events."""

    rows: np.ndarray
    n_events: int

    @property
    def t(self) -> np.ndarray:
        return self.rows[:, 0]

    @property
    def e(self) -> np.ndarray:
        return self.rows[:, 1] - self.rows[:, 2]


def prepare(loop: ExactLoop = IDEAL_HIGH, h_stuck: float = H_STUCK, h_slip: float = H_SLIP) -> Callable[[], Rows]:
    """A function of no arguments that does one run from rest into its own, re-used buffer: the thing to time.

    ``h_stuck``, ``h_slip`` [s] are the RK4 steps. Raises NoCompiler, and ValueError for a loop that the C does not
    cover (integrating process, start away from rest).
    """
    if loop.integrating or loop.PV_0 or loop.z_0 or loop.x_0:
        raise ValueError(
            f"{loop!r}: the C peer covers the lag process from rest only; use stickslip.cases.exact.exact_run"
        )
    numbers = np.array(
        [getattr(loop, name) for name in ("K", "tau", "K_p", "T_i", "M", "k", "F_v", "F_c", "F_s", "SP")]
    )
    rows = np.zeros((round(loop.duration / loop.log_interval) + 1, len(COLUMNS)))
    call = library("ideal_loop").ideal_loop
    call.restype = ctypes.c_int
    pointer, real = ctypes.c_void_p, ctypes.c_double
    call.argtypes = [pointer, ctypes.c_int, real, real, real, pointer]
    arguments = (numbers.ctypes.data, rows.shape[0], loop.log_interval, h_stuck, h_slip, rows.ctypes.data)

    def once() -> Rows:
        return Rows(rows, call(*arguments))

    # ctypes sees addresses only; the closure must keep the arrays behind them alive.
    once.keeps = (numbers, rows)  # type: ignore[attr-defined]
    return once


def run(loop: ExactLoop = IDEAL_HIGH, h_stuck: float = H_STUCK, h_slip: float = H_SLIP) -> Rows:
    """One run of the C loop from rest; see ``prepare``."""
    return prepare(loop, h_stuck, h_slip)()
