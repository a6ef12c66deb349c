"""What simulated loops of known cause say about one record, by what the calibrated model says of both.

    z          log odds of stiction, ln S and ln J over the travel of OP: the model's opinion
    chance     1/(1 + exp(-(a + b z_odds))), a and b fitted to the simulated loops (Platt 1999)
    sizes      the opinion on the record, corrected by the errors of the opinions on the sticky loops nearest in z
    limit      the size from which on a stick is found with the probability ``CHANCE``, where ``FALSE_ALARMS`` of the
               loops without stiction are called sticky

The model has not seen these loops, so its errors on them are those it makes on the record.  A fit of all features to
the few hundred loops of one record tells stiction worse than the model does (area 0.83 against 0.87).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from calibration.records import Table
from calibration.scoring import auc
from detect.judge.model import Model

Floats = NDArray[np.float64]

NEIGHBOURS = 40.0  # loops that a size rests on, about
FALSE_ALARMS = 0.05  # share of loops without stiction that may be called sticky where the detection limit is read
CHANCE = 0.9  # of a stick at the detection limit to be found
QUANTILES = np.array([0.05, 0.5, 0.95])
PENALTY = 0.05  # on a and b squared: keeps them finite where loops part completely


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
        return cls(*chances(np.log(travel), found))

    def travel(self, chance: float) -> float:
        """Return the travel [-] below which the chance is reached; NaN where it does not grow with the stick."""
        return float(np.exp((np.log(chance / (1.0 - chance)) - self.a) / self.b)) if self.b < -1e-3 else np.nan


def chances(x: Floats, yes: NDArray[np.bool_]) -> tuple[float, float]:
    """Return a and b of the chance 1/(1 + exp(-(a + b x))) that best tells ``yes`` (n,) from ``x`` (n,)."""
    y = yes.astype(float)

    def loss(p: Floats) -> float:
        chance = np.clip(expit(p[0] + p[1] * x), 1e-9, 1.0 - 1e-9)
        return float(-(y * np.log(chance) + (1.0 - y) * np.log(1.0 - chance)).sum() + PENALTY * (p @ p))

    best = minimize(loss, np.zeros(2), method="L-BFGS-B").x
    return float(best[0]), float(best[1])


def log_odds(p: Floats) -> Floats:
    """Return ln(p / (1 - p)) of probabilities, kept finite."""
    safe = np.clip(p, 1e-9, 1.0 - 1e-9)
    return np.asarray(np.log(safe / (1.0 - safe)))


def opinions(model: Model, names: list[str], x: Floats) -> Floats:
    """Return z (n, 3) of features (n, f)."""
    own = x[:, [names.index(name) for name in model.names]]
    sizes = [model.sizes(own, which)[:, 1] for which in ("S", "J")]
    return np.column_stack([log_odds(model.probabilities(own)[0]), *sizes])


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


def read(known: Table, x: Floats, model: Model) -> Reading:
    """Return what simulated loops say about a record of features ``x`` (pieces, f)."""
    names, sticky = known.names.tolist(), known.sticky
    z, here = opinions(model, names, known.x), np.median(opinions(model, names, x), axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):  # loops without a stick have no size
        true = np.log(np.column_stack([known.truth[which].astype(float) / known.unit for which in ("S", "J")]))
    a, b = chances(z[:, 0], sticky)
    p = float(expit(a + b * here[0]))
    weights = nearest(z[sticky], here)
    S, J = (
        np.exp(here[k + 1] + weighted_quantile(true[sticky, k] - z[sticky, k + 1], weights, QUANTILES)) for k in (0, 1)
    )
    J = np.minimum(J, S)
    threshold = float(np.quantile(z[~sticky, 0], 1.0 - FALSE_ALARMS))
    others = model.probabilities(x[:, [names.index(name) for name in model.names]])[1].mean(axis=0)
    shares = (1.0 - p) * others / others.sum()
    return Reading(
        causes={"stiction": p, **dict(zip(model.causes, shares.tolist(), strict=True))},
        S=(float(S[1]), float(S[0]), float(S[2])),
        J=(float(J[1]), float(J[0]), float(J[2])),
        limit=_limit(np.exp(-true[sticky, 0]), z[sticky, 0] > threshold),
        loops=len(known),
        false_alarms=float((z[~sticky, 0] > threshold).mean()),
        area=auc(z[:, 0], sticky),
    )


def _limit(travel: Floats, found: NDArray[np.bool_]) -> float:
    """Return the detection limit [travels of OP]; NaN where it lies above the travel itself."""
    most = Curve.fitted(travel, found).travel(CHANCE)
    return 1.0 / most if most >= 1.0 else math.nan
