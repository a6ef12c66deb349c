"""Waves and loops with known shape; every number follows from the formula, none from the code under test."""

from __future__ import annotations

import numpy as np
import pytest

from records import LoopRecord


def _wave(kind, t, period=50.0, phase=0.0, tau=8.0):
    """Amplitude near 1, crossing zero upwards at phase 0."""
    u = (np.asarray(t) / period + phase) % 1.0
    sign, part = np.where(u < 0.5, 1.0, -1.0), 2 * (u % 0.5)  # part: 0 to 1 within the half cycle
    if kind == "sine":
        return np.sin(2 * np.pi * u)
    if kind == "triangle":
        return sign * (1 - np.abs(2 * part - 1))
    if kind == "square":
        return sign
    if kind == "exponential":  # steady response of 1 / (tau s + 1) to a square wave; switches at part = 0
        h = period / 2 / tau
        return sign * (1 - (1 + np.tanh(h / 2)) * np.exp(-part * h))
    raise ValueError(kind)


def _loop(t, e, **more):
    """A flow loop at constant SP with this control error; OP is its running integral, as under a PI."""
    e = np.asarray(e, dtype=float)
    op = 50 + 0.05 * (e + np.cumsum(np.nan_to_num(e)) * 0.02)
    more.setdefault("process", "self_regulating")
    return LoopRecord.from_arrays(t, pv=30 - e, op=op, sp=np.full(len(e), 30.0), name="FIC1", **more)


@pytest.fixture
def wave():
    return _wave


@pytest.fixture
def loop():
    return _loop
