"""Waves and loops with known shape; every number follows from the formula, none from the code under test."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from logs import LoopRecord


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


def _noise(kind, n, seed):
    """Noise without any period: white, AR(1), a random walk, white noise through two lags, a loop under a walk."""
    rng = np.random.default_rng([2009, seed, n])
    w = rng.normal(size=n + 1000)
    if kind == "white":
        x = w
    elif kind == "walk":
        x = np.cumsum(w)
    elif kind == "two lags":
        x = lfilter([1], [1, -np.exp(-1 / 10)], lfilter([1], [1, -np.exp(-1 / 30)], w))
    elif kind == "loop":  # PI with K_p = 1, T_i = 10 on 1 / (10 s + 1), one sample a second, walk at the input:
        # e = -s / (10 s + 1) / (s + 0.1) * load, hence white noise through two equal lags of 10
        x = lfilter([1], [1, -2 * np.exp(-0.1), np.exp(-0.2)], w)
    else:
        x = lfilter([1], [1, -kind], w)
    return x[1000:]


@pytest.fixture
def noise():
    return _noise


@pytest.fixture
def wave():
    return _wave


@pytest.fixture
def loop():
    return _loop
