"""Judge one record by simulated loops of known cause: the network of convolutions compares them.

    z          log odds of stiction, ln S and ln J over the travel of OP (``stickslip.detect.judge.features.network``)
    d          distance from the record to a loop in z, each number over its spread among the loops
    weight     exp(-(d / (0.6 D))^2 / 2),   D the distance of the ``NEIGHBOURS``-th loop
    stiction   1/(1 + exp(-(a + b (z - z_record)))) at the record, a and b (3,) fitted to the loops by their weights
    causes     what is left, shared as the weights of the loops without stiction are
    sizes      what the network says of the record, corrected by its errors on the sticky loops, by their weights
    limit      the size from which on a stick is found with the probability ``CHANCE``, where ``FALSE_ALARMS`` of the
               loops without stiction are called sticky

The network has not seen these loops, so its errors on them are those it makes on the record.  Three numbers, and not
all scores: a fit of more to the loops of one record tells stiction in other physics worse
(docs/evidence/methods_measured.md).

Source of the fit: C. Loader, Local regression and likelihood, Springer 1999, chapter 4.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression, minimize
from scipy.special import expit
from stickslip.calibration.records import Table
from stickslip.calibration.scoring import auc
from stickslip.calibration.spec import CAUSES
from stickslip.logs.arrays import Values

SEEN = ("network_sticky", "network_S", "network_J")  # z
NEIGHBOURS = 300.0  # loops that the answer rests on, about
FALSE_ALARMS = 0.05  # share of loops without stiction that may be called sticky where the detection limit is read
CHANCE = 0.9  # of a stick at the detection limit to be found
LARGER = 30  # sticky loops beyond the limit, at least
QUANTILES = np.array([0.05, 0.5, 0.95])
PENALTY = 0.05  # on a and b squared: keeps them finite where loops part completely
STEEP = 1.5  # the same on the slopes near the record, whose loops are fewer


def weighted_quantile(values: Values, weights: Values, at: Values) -> Values:
    """Return the quantiles ``at`` of values with weights.

    >>> weighted_quantile(np.array([1.0, 2.0, 3.0]), np.ones(3), np.array([0.5])).tolist()
    [2.0]
    """
    order = np.argsort(values)
    share = (np.cumsum(weights[order]) - 0.5 * weights[order]) / weights.sum()
    return np.asarray(np.interp(at, share, values[order]), dtype=np.float64)


def nearest(points: Values, at: Values, count: float = NEIGHBOURS) -> Values:
    """Return weights of ``points`` (n, d) by their distance to ``at`` (d,), of about ``count`` neighbours."""
    spread = np.maximum(points.std(axis=0), 1e-9)
    distance = np.sqrt((((points - at) / spread) ** 2).sum(axis=1))
    width = max(float(np.sort(distance)[min(len(distance) - 1, int(count))]), 1e-9)
    return np.asarray(np.exp(-0.5 * (distance / (0.6 * width)) ** 2))


def chances(x: Values, yes: NDArray[np.bool_], weights: Values, penalty: Values) -> Values:
    """Return a and b (1 + d,) of the chance 1/(1 + exp(-(a + x b))) that best tells ``yes`` (n,) from ``x`` (n, d).

    ``weights`` of the loops (n,); ``penalty`` on the square of each of a and b (1 + d,).
    """
    columns = np.column_stack([np.ones(len(x)), x])

    def loss(p: Values) -> tuple[float, Values]:
        z = columns @ p
        wrong = np.logaddexp(0.0, np.where(yes, -z, z))
        slope = columns.T @ (weights * (expit(z) - yes)) + 2.0 * penalty * p
        return float(weights @ wrong + penalty @ p**2), slope

    return np.asarray(minimize(loss, np.zeros(columns.shape[1]), jac=True, method="L-BFGS-B").x)


def log_odds(p: Values) -> Values:
    """Return ln(p / (1 - p)) of probabilities, kept finite."""
    safe = np.clip(p, 1e-9, 1.0 - 1e-9)
    return np.asarray(np.log(safe / (1.0 - safe)))


@dataclass(frozen=True)
class Reading:
    """The judgement of a record by simulated loops.

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


def read(known: Table, here: Values) -> Reading:
    """Return what simulated loops say about a record of scores ``here`` (pieces, 3), by ``SEEN``."""
    names, sticky = known.names.tolist(), known.sticky
    z, at = known.x[:, [names.index(name) for name in SEEN]], np.median(here, axis=0)
    weights = nearest(z, at)
    ahead = (z - at) / np.maximum(z.std(axis=0), 1e-9)
    p = float(expit(chances(ahead, sticky, weights, np.array([PENALTY, STEEP, STEEP, STEEP]))[0]))
    own = weights[sticky]
    true = np.log(np.column_stack([known.truth[which][sticky].astype(float) for which in ("S", "J")]))
    true -= np.log(known.unit[sticky])[:, None]
    S, J = (np.exp(at[k] + weighted_quantile(true[:, k - 1] - z[sticky, k], own, QUANTILES)) for k in (1, 2))
    J = np.minimum(J, S)
    threshold = float(np.quantile(z[~sticky, 0], 1.0 - FALSE_ALARMS))
    return Reading(
        causes={"stiction": p, **_shared(1.0 - p, known.truth["cause"][~sticky], weights[~sticky])},
        S=(float(S[1]), float(S[0]), float(S[2])),
        J=(float(J[1]), float(J[0]), float(J[2])),
        limit=detection_limit(np.exp(true[:, 0]), z[sticky, 0] > threshold),
        loops=len(known),
        false_alarms=float((z[~sticky, 0] > threshold).mean()),
        area=auc(z[:, 0], sticky),
    )


def _shared(left: float, causes: NDArray[np.generic], weights: Values) -> Mapping[str, float]:
    """Return the probability of each cause but stiction, by the weights of loops of these causes; none is excluded."""
    others = [cause for cause in CAUSES if cause != "stiction"]
    sums = np.array([weights[causes == cause].sum() for cause in others]) + 0.5 / len(others)
    return dict(zip(others, (left * sums / sums.sum()).tolist(), strict=True))


def detection_limit(size: Values, found: NDArray[np.bool_]) -> float:
    """Return the size from which on sticks are found with the probability ``CHANCE``; NaN where there is none up to 1.

    size : (n,) S of the loops over the travel of OP [-]; larger ones than 1 stand still and count for nothing
    found : (n,) whether each was found

    The share found is fitted as one that never falls with the size (isotonic regression), because it need not come
    near to 1: noise hides some sticks of any size.  At least ``LARGER`` of the loops must lie beyond the limit.
    """
    order = np.argsort(size)[: int(np.sum(size <= 1.0))]
    if len(order) < LARGER:
        return math.nan
    share = isotonic_regression(found[order].astype(float)).x
    first = int(np.searchsorted(share, CHANCE))
    return float(size[order[first]]) if len(order) - first >= LARGER else math.nan
