"""The linear rival: every lag with a response that never changes sign, fitted by least squares.

    y(t) = s * sum over lags k of g(k) x(t - k) + slow load,    g(k) >= 0

The impulse response g is a polygon whose corners stand wider with the lag.  Because they may not change
sign, any chain of lags and dead time can be had, and a differentiation cannot: with one the model would pass off the
controller, whose inverse turns OP back into PV exactly, for the process.  s is the sign of the process gain.  An
integrating process has the integral of x in the place of x.  The slow load is a mean, a ramp where the process
integrates, and cosines too slow for the swing.
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.stem.nonnegative import nonnegative
from stickslip.logs.arrays import Indices, Values

REACH = 4.0  # of the time between turns: how long the response may be
WIDER = 1.35  # one corner's lag over the last's
SLOW = 6.0  # of the time between turns: a longer swing is taken for load
WAVES_MAX = 40
SETTLES = 2.0  # of the time between turns: how long what happened before the record is felt most; left out of the sums


class Response(NamedTuple):
    """Sum of squares of the residual, weights (p,), mean lag of the response [samples]."""

    rss: float
    weights: Values
    lag: float


class Lags:
    """The model for one measurement y (n,) whose swing turns every ``turn`` samples.

    ``sign`` is that of the process gain.  Of y the first two turns are left out, and ``rows`` samples of the rest are
    compared, spread unevenly, so that they fall into step with no wave; None compares all.  ``waves`` (n, w) are loads
    beside the slow one.

    >>> u = np.cumsum(np.random.default_rng(0).normal(size=400))
    >>> late = np.concatenate([np.zeros(3), u[:-3]])
    >>> model = Lags(late, turn=28.0)
    >>> fit = model.fit(u[:, None])[0]
    >>> fit.rss < 0.02 * model.tss, round(fit.lag)
    (True, 3)
    """

    def __init__(
        self, y: Values, turn: float, integrating: bool = False, sign: float = 1.0, rows: int | None = None,
        waves: Values | None = None,
    ) -> None:  # fmt: skip
        n = len(y)
        corners = max(round(math.log(REACH * turn) / math.log(WIDER)), 2)
        ends = {-1, 0, *np.round(np.geomspace(1.0, REACH * turn, corners)).astype(int)}
        self.knots = np.array(sorted(e for e in ends if e < n), dtype=np.intp)
        self.integrating, self.sign = integrating, sign
        first = int(SETTLES * turn) if n >= 12.0 * turn else 0  # in few turns every one counts
        self.rows = first + _spread(n - first, rows)
        steps = (self.rows + 0.5) / n
        slow = min(int(2.0 * n / (SLOW * turn)), WAVES_MAX)
        load = np.cos(np.pi * steps[:, None] * np.arange(slow + 1.0))
        if integrating:
            load = np.column_stack([load, steps])
        if waves is not None:
            load = np.column_stack([load, waves[self.rows]])
        self.load = np.linalg.qr(load)[0]
        self.y = self._freed(y[self.rows])
        self.tss = float(self.y @ self.y)

    def _freed(self, x: Values) -> Values:
        return np.asarray(x - self.load @ (self.load.T @ x))

    def columns(self, x: Values) -> Values:
        """What each corner of g alone would make of x (n, m), shape (m, p, rows); x stands still before its start."""
        from stickslip.detect.stem.kernels import polygons

        out = np.empty((x.shape[1], len(self.knots) - 2, len(self.y)))
        polygons(np.ascontiguousarray(x.T, dtype=float), self.knots, self.integrating, self.rows, out)
        return out

    def fit(self, x: Values) -> list[Response]:
        """The best response to each of the inputs x (n, m)."""
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
        found: list[Response] = []
        for g, b in zip(gram, product, strict=True):
            weights = nonnegative(g, b, found[-1].weights if found else None)
            rss = max(self.tss - 2.0 * float(b @ weights) + float(weights @ g @ weights), 1e-12 * self.tss)
            mass = widths * weights
            total = float(mass.sum())
            lag = float((self.knots[1:-1]) @ mass) / total if total > 0.0 else 0.0
            found.append(Response(rss, weights, lag))
        return found

    def residual(self, x: Values, response: Response) -> Values:
        """What is left of y, shape (rows,)."""
        explained = response.weights @ self.columns(x[:, None])[0]
        return np.asarray(self.y - self.sign * self._freed(explained))


def _spread(n: int, rows: int | None) -> Indices:
    """So many samples of n, in order: one at random of each of as many stretches, the same at every call."""
    if rows is None or rows >= n:
        return np.arange(n)
    edges = n * np.arange(rows) / rows
    return np.asarray(edges + np.random.default_rng(0).uniform(0.0, n / rows, rows), dtype=np.intp)
