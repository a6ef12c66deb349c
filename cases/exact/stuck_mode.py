"""Closed form of the loop while the stem is stuck: x constant, v = 0."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from stickslip.cases.exact.parameters import ExactLoop

Array = NDArray[np.float64]


class StuckMode:
    """The stuck loop from a state (y, z, x, 0) at t = 0.

    Lag process (a < 0), with y_oo = -b x / a and w = y_0 - y_oo:
        y = y_oo + w exp(a t),    z = z_0 + K_i [(SP - y_oo) t - w (exp(a t) - 1)/a].
    Integrating process (a = 0):
        y = y_0 + b x t,          z = z_0 + K_i [(SP - y_0) t - b x t^2 / 2].
    """

    def __init__(self, loop: ExactLoop, state: Array) -> None:
        self._loop = loop
        self._y0, self._z0, self._x = float(state[0]), float(state[1]), float(state[2])

    def at(self, t: Array) -> Array:
        """State at the times t [s] since the mode began, shape (4, n)."""
        loop, rate = self._loop, self._loop.b * self._x
        if loop.a == 0.0:
            y = self._y0 + rate * t
            z = self._z0 + loop.K_i * ((loop.SP - self._y0) * t - 0.5 * rate * t * t)
        else:
            y_oo = -rate / loop.a
            w = self._y0 - y_oo
            y = y_oo + w * np.exp(loop.a * t)
            z = self._z0 + loop.K_i * ((loop.SP - y_oo) * t - w * np.expm1(loop.a * t) / loop.a)
        return np.stack([y, z, np.full_like(y, self._x), np.zeros_like(y)])

    def dwell(self, left: float) -> float | None:
        """Time [s] until |OP - x| first exceeds F_s/k, or None if that is later than ``left``.

        dOP/dt has at most one zero, so OP is monotone on either side of it: no crossing can hide.
        """
        if self._excess(0.0) > 0.0:
            return 0.0
        turn = self._turning_time()
        pieces = [(0.0, left)] if not 0.0 < turn < left else [(0.0, turn), (turn, left)]
        for start, end in pieces:
            if self._excess(end) > 0.0:
                if self._excess(start) == 0.0:
                    return start
                return float(brentq(self._excess, start, end, xtol=1e-15, rtol=1e-15))
        return None

    def _excess(self, t: float) -> float:
        y, z, x, _ = self.at(np.array([t]))[:, 0]
        loop = self._loop
        return abs(float(loop.K_p * (loop.SP - y) + z - x)) - loop.f_s

    def _turning_time(self) -> float:
        """Time at which dOP/dt = 0, nan if never."""
        loop, rate = self._loop, self._loop.b * self._x
        if loop.a == 0.0:
            slope = loop.K_i * rate
            return math.nan if slope == 0.0 else (loop.SP - self._y0) / rate - loop.T_i
        # dOP/dt = K_i (SP - y_oo) - (K_p a + K_i) w exp(a t)
        y_oo = -rate / loop.a
        decaying = (loop.K_p * loop.a + loop.K_i) * (self._y0 - y_oo)
        ratio = loop.K_i * (loop.SP - y_oo) / decaying if decaying != 0.0 else 0.0
        return math.log(ratio) / loop.a if ratio > 0.0 else math.nan
