"""What simulated loops of known cause say about one record with the same features.

    score    ridge-penalised logistic regression of the causes on the ranks of the features, fitted on the other folds
             min_W  -sum_i log softmax(W z_i)[cause_i] + (ridge/2) |W|^2,     z  normal scores of the ranks
    size     ridge regression of log(S / range of OP) and log(J / S) on the same z, over the sticky loops
    interval the sticky loops nearest to the record in score and size, their truth weighted by a normal kernel

Each simulated loop is scored by a fit that has not seen it, so that what is read off the neighbours and the detection
limit is as honest as for the record.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, log_softmax, ndtri, softmax

from calibration.records import Table
from calibration.scoring import auc
from calibration.spec import CAUSES
from detect.judge.model import Model

Floats = NDArray[np.float64]
Whole = NDArray[np.intp]

RIDGE = 30.0  # penalty of the weights, for features of unit variance
FREE = 0.01  # share of it on the constant and on what is known to be telling
FOLDS = 4
NEIGHBOURS = 40.0  # loops that the interval rests on, about
FALSE_ALARMS = 0.02  # share of loops without stiction that may be called sticky where the detection limit is read
CHANCE = 0.9  # of a stick at the detection limit to be found
QUANTILES = np.array([0.05, 0.5, 0.95])
STICTION = CAUSES.index("stiction")


@dataclass(frozen=True, eq=False)
class Scores:
    """What loops are compared by: normal scores of the ranks of their features, and the opinion of stage (a).

    A feature that is missing stands in the middle and says so in a column of its own.
    """

    names: list[str]
    ranks: tuple[Floats, ...]
    model: Model | None
    mean: Floats
    spread: Floats

    @classmethod
    def of(cls, x: Floats, names: list[str], model: Model | None = None) -> "Scores":
        """Learn the ranks of the features (n, f) of simulated loops, and how far the opinions on them spread."""
        said = _opinions(x, names, model)
        ranks = tuple(np.sort(column[np.isfinite(column)]) for column in x.T)
        return cls(names, ranks, model, said.mean(axis=0), np.maximum(said.std(axis=0), 1e-9))

    @property
    def free(self) -> int:
        """Columns that are hardly penalised: the constant and the opinions."""
        return 1 + len(self.mean)

    def __call__(self, x: Floats) -> Floats:
        """Return constant, opinions, scores and what is missing, (m, columns), of features (m, f)."""
        z: Floats = np.zeros(x.shape)
        for k, known in enumerate(self.ranks):
            if len(known) > 1 and known[0] < known[-1]:
                low, high = np.searchsorted(known, x[:, k], "left"), np.searchsorted(known, x[:, k], "right")
                z[:, k] = ndtri((0.5 * (low + high) + 0.5) / (len(known) + 1.0))
        missing = ~np.isfinite(x)
        z[missing] = 0.0
        said = (_opinions(x, self.names, self.model) - self.mean) / self.spread
        return np.hstack([np.ones((len(x), 1)), said, z, missing.astype(np.float64)])


def _opinions(x: Floats, names: list[str], model: Model | None) -> Floats:
    """Return what stage (a) says of features (n, f): log odds of causes, ln S and ln J; nothing without a model."""
    if model is None:
        return np.zeros((len(x), 0))
    own = x[:, [names.index(name) for name in model.names]]
    p, others = model.probabilities(own)
    causes = np.log(np.maximum(others / np.maximum(1.0 - p, 1e-9)[:, None], 1e-4))
    return np.hstack([log_odds(p)[:, None], causes, model.sizes(own, "S"), model.sizes(own, "J")])


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


def log_odds(p: Floats) -> Floats:
    """Return ln(p / (1 - p)) of probabilities, kept finite."""
    safe = np.clip(p, 1e-9, 1.0 - 1e-9)
    return np.asarray(np.log(safe / (1.0 - safe)))


@dataclass(frozen=True)
class Reading:
    """What the simulated loops say of a record.

    causes : probability of each cause [-]
    S, J : value, low and high [travels of OP], interval of 90 %
    limit : S above which a stick is found with the probability ``CHANCE`` [travels of OP]; NaN where none is
    loops, false_alarms, area : as in ``AtRecord``
    """

    causes: dict[str, float]
    S: tuple[float, float, float]
    J: tuple[float, float, float]
    limit: float
    loops: int
    false_alarms: float
    area: float


def read(known: Table, scores: Scores, x: Floats) -> Reading:
    """Return what simulated loops say about a record of features ``x`` (pieces, f)."""
    z, at, free = scores(known.x), scores(x), scores.free
    cause = np.array([CAUSES.index(word) for word in known.truth["cause"].tolist()], dtype=np.intp)
    sticky = known.sticky
    with np.errstate(invalid="ignore"):
        size = np.log(known.truth["S"].astype(float) / known.unit)  # of the travel of OP; NaN where there is none
        share = known.truth["J"].astype(float) / known.truth["S"].astype(float)
    unseen, told, fold = np.zeros((len(known), len(CAUSES))), np.zeros((len(known), 2)), folds(len(known))
    for k in range(int(fold.max()) + 1):
        fit, test = fold != k, fold == k
        unseen[test] = probabilities(logistic(z[fit], cause[fit], len(CAUSES), free=free), z[test])
        own = fit & sticky
        for column, y in enumerate((size, share)):
            told[test, column] = z[test] @ ridge_fit(z[own], y[own], free=free)
    odds = log_odds(unseen[:, STICTION])
    pieces = np.log(np.maximum(probabilities(logistic(z, cause, len(CAUSES), free=free), at), 1e-12)).mean(axis=0)
    mine = softmax(pieces)
    p = platt(odds, sticky, float(log_odds(mine[STICTION : STICTION + 1])[0]))
    left = (1.0 - p) / max(1.0 - float(mine[STICTION]), 1e-12)
    here = np.array([np.median(at @ ridge_fit(z[sticky], y[sticky], free=free)) for y in (size, share)])
    weights = nearest(told[sticky], here)
    S = np.exp(here[0] + weighted_quantile(size[sticky] - told[sticky, 0], weights, QUANTILES))
    parts = np.clip(here[1] + weighted_quantile(share[sticky] - told[sticky, 1], weights, QUANTILES), 0.02, 1.0)
    threshold = float(np.quantile(odds[~sticky], 1.0 - FALSE_ALARMS))
    return Reading(
        causes={str(word): p if word == "stiction" else float(v) * left for word, v in zip(CAUSES, mine, strict=True)},
        S=(float(S[1]), float(S[0]), float(S[2])),
        J=(float(S[1] * parts[1]), float(S[0] * parts[0]), float(S[2] * parts[2])),
        limit=_limit(np.exp(-size[sticky]), odds[sticky] > threshold),
        loops=len(known),
        false_alarms=float((odds[~sticky] > threshold).mean()),
        area=auc(odds, sticky),
    )


def platt(odds: Floats, sticky: NDArray[np.bool_], mine: float) -> float:
    """Return the probability at log odds ``mine``, calibrated on loops that the fits had not seen (Platt 1999)."""
    z = np.column_stack([np.ones(len(odds)), odds])
    return float(probabilities(logistic(z, sticky.astype(np.intp), 2), np.array([[1.0, mine]]))[0, 1])


def _limit(travel: Floats, found: NDArray[np.bool_]) -> float:
    """Return the detection limit [travels of OP]; NaN where the chance is not reached by any stick simulated."""
    most = Curve.fitted(travel, found).travel(CHANCE)
    return 1.0 / most if most >= float(np.quantile(travel, 0.02)) else math.nan
