"""The linear rival: every lag with a response that never changes sign, fitted by least squares.

    y(t) = s * sum over lags k of g(k) x(t - k) + slow load,    g(k) >= 0

The impulse response g is a polygon whose corners stand wider with the lag.  Because they may not change
sign, any chain of lags and dead time can be told, and a differentiation cannot: with one the model would pass off the
controller, whose inverse turns OP back into PV exactly, for the process.  s is the sign of the process gain.  An
integrating process has the integral of x in the place of x.  The slow load is a mean, a ramp where the process
integrates, and cosines too slow for the swing.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = ["Lags", "Response"]

Values = npt.NDArray[np.float64]
REACH = 4.0  # of the time between turns: how long the response may be
WIDER = 1.35  # one corner's lag over the last's
SLOW = 6.0  # of the time between turns: a longer swing is taken for load
WAVES_MAX = 40


class Response(NamedTuple):
    """Sum of squares of the residual, weights (p,), mean lag of the response [samples]."""

    rss: float
    weights: Values
    lag: float


class Lags:
    """The model for one measurement y (n,) whose swing turns every ``turn`` samples.

    ``sign`` is that of the process gain; only ``every`` n-th sample of y is compared.

    >>> u = np.sin(np.arange(400.0) / 9)
    >>> late = np.concatenate([np.zeros(3), u[:-3]])
    >>> model = Lags(late, turn=28.0)
    >>> fit = model.fit(u[:, None])[0]
    >>> fit.rss < 0.02 * model.tss, round(fit.lag)
    (True, 3)
    """

    def __init__(self, y: Values, turn: float, integrating: bool = False, sign: float = 1.0, every: int = 1) -> None:
        n = len(y)
        corners = max(round(math.log(REACH * turn) / math.log(WIDER)), 2)
        ends = {-1, 0, *np.round(np.geomspace(1.0, REACH * turn, corners)).astype(int)}
        self.knots = np.array(sorted(e for e in ends if e < n), dtype=np.intp)
        self.integrating, self.sign = integrating, sign
        self.every = every
        y = y[::every]
        steps = (np.arange(len(y)) + 0.5) / len(y)
        waves = min(int(2.0 * n / (SLOW * turn)), WAVES_MAX)
        self.load = np.cos(np.pi * steps[:, None] * np.arange(waves + 1.0))
        self.load /= np.linalg.norm(self.load, axis=0)
        if integrating:
            ramp = self._freed(steps)
            self.load = np.column_stack([self.load, ramp / np.linalg.norm(ramp)])
        self.y = self._freed(y)
        self.tss = float(self.y @ self.y)

    def _freed(self, x: Values) -> Values:
        return np.asarray(x - self.load @ (self.load.T @ x))

    def columns(self, x: Values) -> Values:
        """What each corner of g alone would make of x (n, m), shape (m, p, n); x stands still before its start."""
        n, m = x.shape
        reach = int(self.knots[-1])
        rows = np.ascontiguousarray(x.T)
        if self.integrating:
            rows = np.cumsum(rows - np.mean(rows, axis=1, keepdims=True), axis=1)
            before = rows[:, :1] - (rows[:, 1:2] - rows[:, :1]) * np.arange(reach, 0, -1)
        else:
            before = np.broadcast_to(rows[:, :1], (m, reach))
        area = np.zeros((m, n + reach + 1))
        np.cumsum(np.concatenate([before, rows], axis=1), axis=1, out=area[:, 1:])
        np.cumsum(area, axis=1, out=area)
        out = np.empty((m, len(self.knots) - 2, len(self.y)))
        slopes = []
        for a, b in itertools.pairwise(self.knots):
            first, last = reach - int(a), reach - int(b)
            later, sooner = area[:, first : first + n : self.every], area[:, last : last + n : self.every]
            slopes.append((later - sooner) / (b - a))
        for i in range(len(slopes) - 1):
            np.subtract(slopes[i], slopes[i + 1], out[:, i])
        return out

    def fit(self, x: Values) -> list[Response]:
        """The best response to each of the inputs x (n, m)."""
        from scipy.optimize import nnls

        columns = self.columns(x)
        load = np.matmul(columns, self.load)
        gram = np.matmul(columns, columns.transpose(0, 2, 1))
        whole = np.trace(gram, axis1=1, axis2=2)  # what rounding is measured by
        gram -= np.matmul(load, load.transpose(0, 2, 1))
        product = self.sign * np.matmul(columns, self.y)
        widths = 0.5 * (self.knots[2:] - self.knots[:-2])
        # A stem that hardly moves leaves little more than rounding beside the load: a ridge keeps that from a fit.
        ridge = 1e-10 * whole + 1e-12 * self.tss
        gram[:, range(len(widths)), range(len(widths))] += ridge[:, None]
        found = []
        for g, b in zip(gram, product, strict=True):
            root = np.linalg.cholesky(g)
            weights = nnls(root.T, np.linalg.solve(root, b))[0]
            rss = max(self.tss - 2.0 * float(b @ weights) + float(weights @ g @ weights), 1e-12 * self.tss)
            mass = widths * weights
            total = float(mass.sum())
            lag = float((self.knots[1:-1]) @ mass) / total if total > 0.0 else 0.0
            found.append(Response(rss, weights, lag))
        return found

    def residual(self, x: Values, response: Response) -> Values:
        """What is left of y, shape (n,)."""
        told = response.weights @ self.columns(x[:, None])[0]
        return np.asarray(self.y - self.sign * self._freed(told))
