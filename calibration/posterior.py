"""What simulated loops of known cause say about one record with the same features.

    score    ridge-penalised logistic regression of the causes on the ranks of the features, fitted on the other folds
             min_W  -sum_i log softmax(W z_i)[cause_i] + (ridge/2) |W|^2,     z  normal scores of the ranks
    size     ridge regression of log(S / range of OP) and log(J / S) on the same z, over the sticky loops
    interval the sticky loops nearest to the record in score and size, their truth weighted by a normal kernel

Each simulated loop is scored by a fit that has not seen it, so that what is read off the neighbours and the detection
limit is as honest as for the record.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, log_softmax, ndtri, softmax

Floats = NDArray[np.float64]
Whole = NDArray[np.intp]

RIDGE = 30.0  # penalty of the weights, for features of unit variance
FREE = 0.01  # share of it on the constant and on what is known to be telling
FOLDS = 4
NEIGHBOURS = 40.0  # loops that the interval rests on, about


@dataclass(frozen=True, eq=False)
class Scaled:
    """Features as normal scores of their ranks among the simulated loops; what is missing stands in the middle."""

    sorted: tuple[Floats, ...]

    @classmethod
    def of(cls, x: Floats) -> "Scaled":
        """Learn the ranks of features (n, f)."""
        return cls(tuple(np.sort(column[np.isfinite(column)]) for column in x.T))

    def __call__(self, x: Floats) -> Floats:
        """Return the scores of features (m, f), and whether each is missing: (m, 2 f + 1)."""
        z: Floats = np.zeros(x.shape)
        for k, known in enumerate(self.sorted):
            if len(known) > 1 and known[0] < known[-1]:
                low, high = np.searchsorted(known, x[:, k], "left"), np.searchsorted(known, x[:, k], "right")
                z[:, k] = ndtri((0.5 * (low + high) + 0.5) / (len(known) + 1.0))
        missing = ~np.isfinite(x)
        z[missing] = 0.0
        return np.hstack([np.ones((len(x), 1)), z, missing.astype(np.float64)])


def logistic(z: Floats, cause: Whole, count: int, ridge: float = RIDGE, free: int = 1) -> Floats:
    """Return the weights (count, f) of the module docstring; the first ``free`` features are hardly penalised."""
    told = np.eye(count)[cause]
    held = np.ones(z.shape[1])
    held[:free] = FREE

    def loss(flat: Floats) -> tuple[float, Floats]:
        w = flat.reshape(count, -1)
        logs = log_softmax(z @ w.T, axis=1)
        slope = (np.exp(logs) - told).T @ z + ridge * held * w
        return float(-(told * logs).sum() + 0.5 * ridge * (held * w * w).sum()), slope.ravel()

    found = minimize(loss, np.zeros(count * z.shape[1]), jac=True, method="L-BFGS-B", options={"maxiter": 150})
    weights: Floats = found.x.reshape(count, -1)
    return weights


def ridge_fit(z: Floats, y: Floats, ridge: float = RIDGE, free: int = 1) -> Floats:
    """Return the weights (f,) of a ridge regression; the first ``free`` features are hardly penalised."""
    held = np.ones(z.shape[1])
    held[:free] = FREE
    return np.asarray(np.linalg.solve(z.T @ z + ridge * np.diag(held), z.T @ y), dtype=np.float64)


def folds(n: int, count: int = FOLDS) -> Whole:
    """Return the fold of each of ``n`` loops; neighbours in the order of drawing, sticky and not, share one."""
    return np.asarray((np.arange(n) // 2) % count, dtype=np.intp)


def weighted_quantile(values: Floats, weights: Floats, at: Floats) -> Floats:
    """Return the quantiles ``at`` of values with weights.

    >>> weighted_quantile(np.array([1.0, 2.0, 3.0]), np.ones(3), np.array([0.5])).tolist()
    [2.0]
    """
    order = np.argsort(values)
    share = (np.cumsum(weights[order]) - 0.5 * weights[order]) / weights.sum()
    return np.asarray(np.interp(at, share, values[order]), dtype=np.float64)


def nearest(points: Floats, at: Floats, count: float = NEIGHBOURS) -> Floats:
    """Return weights of ``points`` (n, d) by their distance to ``at`` (d,), of about ``count`` neighbours."""
    spread = np.maximum(points.std(axis=0), 1e-9)
    distance = np.sqrt((((points - at) / spread) ** 2).sum(axis=1))
    width = max(float(np.sort(distance)[min(len(distance) - 1, int(count))]), 1e-9)
    return np.asarray(np.exp(-0.5 * (distance / (0.6 * width)) ** 2))


@dataclass(frozen=True, eq=False)
class Curve:
    """The chance that a stick is found, over the range of OP in units of S [-]: large sticks have little travel.

    chance = 1/(1 + exp(-(a + b log travel))), fitted by maximum likelihood.
    """

    a: float
    b: float

    @classmethod
    def fitted(cls, travel: Floats, found: NDArray[np.bool_]) -> "Curve":
        """Fit the curve to loops of known travel (n,) and whether each was found (n,)."""
        x, y = np.log(travel), found.astype(float)

        def loss(p: Floats) -> float:
            chance = np.clip(expit(p[0] + p[1] * x), 1e-9, 1.0 - 1e-9)
            return float(-(y * np.log(chance) + (1.0 - y) * np.log(1.0 - chance)).sum() + 0.05 * (p @ p))

        best = minimize(loss, np.zeros(2), method="L-BFGS-B")
        return cls(float(best.x[0]), float(best.x[1]))

    def travel(self, chance: float) -> float:
        """Return the travel [-] below which the chance is reached; NaN where it does not grow with the stick."""
        return float(np.exp((np.log(chance / (1.0 - chance)) - self.a) / self.b)) if self.b < -1e-3 else np.nan


def probabilities(weights: Floats, z: Floats) -> Floats:
    """Return the probability of each cause (n, count)."""
    return np.asarray(softmax(z @ weights.T, axis=1))
