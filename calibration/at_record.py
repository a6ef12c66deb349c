"""A verdict by simulation at the record's own conditions: stage (b) of the combined verdict.

The record's conditions are measured, loops of known cause are simulated under them, and probabilities, sizes and the
detection limit are read off those whose features are nearest to the record's.  See ``conditions``, ``alike`` and
``posterior``.  A long record is looked at in pieces, whose scores are averaged; loops are as long as a piece.
"""

import math
import os
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.alike import alike
from calibration.conditions import Conditions, conditions
from calibration.posterior import (
    Curve,
    Scaled,
    folds,
    logistic,
    nearest,
    probabilities,
    ridge_fit,
    weighted_quantile,
)  # fmt: skip
from calibration.records import Table, row, table
from calibration.simulation import simulate
from calibration.spec import CAUSES, LoopSpec
from detect.judge.model import Model
from logs import LoopRecord

Floats = NDArray[np.float64]

LOOPS = 1000
PIECE, PIECES = 500, 4  # samples of a piece, and how many at most
FEWEST = 60  # loops with features below which nothing is said
FALSE_ALARMS = 0.02  # share of loops without stiction that may be called sticky where the detection limit is read
CHANCE = 0.9  # of a stick at the detection limit to be found
QUANTILES = np.array([0.05, 0.5, 0.95])
STICTION = CAUSES.index("stiction")


@dataclass(frozen=True)
class Amount:
    """A size with the interval that holds it with 90 % probability; ``unit`` "%" of OP span or "OP units"."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class AtRecord:
    """What simulation at a record's conditions says.

    probability : float        of stiction, where half of all loops stick [-]
    causes : mapping           probability of each of ``CAUSES`` [-]
    S, J : Amount              if the valve sticks
    detection_limit : float    a stick larger than this would have shown with 90 % probability [unit of S]; NaN where
                               no stick would have
    unit : str                 "%" of OP span, or "OP units" where the span is not known
    conditions : Conditions
    loops : int                simulated loops with features
    false_alarms : float       of them without stiction, share called sticky at the threshold of the detection limit
    area : float               under the curve of hits over false alarms among the simulated loops [-]
    seconds : float            it took
    """

    probability: float
    causes: Mapping[str, float]
    S: Amount
    J: Amount
    detection_limit: float
    unit: str
    conditions: Conditions
    loops: int
    false_alarms: float
    area: float
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """Return the answer as plain values that JSON can hold; what is not a number is None."""
        given = asdict(replace(self, causes=dict(self.causes)))
        given["detection_limit"] = {
            "value": None if math.isnan(self.detection_limit) else self.detection_limit, "unit": self.unit,
            "chance": CHANCE, "false_alarms": FALSE_ALARMS,
        }  # fmt: skip
        return given

    @property
    def sentence(self) -> str:
        """The detection limit in words."""
        if math.isnan(self.detection_limit):
            return "In this record no stick of any size would have shown with 90 % probability."
        size = f"{self.detection_limit:.2g} {'% of OP span' if self.unit == '%' else 'units of OP'}"
        return f"A stick of more than {size} would have shown in this record with 90 % probability."


def at_record(
    record: LoopRecord, loops: int = LOOPS, seed: int = 0, workers: int | None = None, model: Model | None = None
) -> AtRecord:
    """Return what ``loops`` simulated loops under the record's conditions say of it; equal seeds give equal answers.

    ``workers`` processes (default all cores); ``model`` of stage (a), whose opinion on the record and on every
    simulated loop is among what they are compared by.  Raises ``ValueError`` if the record shows too little (fewer
    than 40 good samples, OP or PV that does not move), or too few of the simulated loops do.

    See also: ``calibration.conditions`` for what is taken from the record.
    """
    begun = time.perf_counter()
    pieces = split(record)
    looks = [(seen, shown) for piece in pieces if (seen := _measured(piece)) and (shown := row(piece))]
    if not looks:
        conditions(record)  # says what is wrong, where it is that
        raise ValueError("the record shows too little for any feature; give a longer one in which OP and PV move")
    seen = _typical([one for one, _ in looks])
    made = simulated(alike(seen, loops, seed), workers)
    known = made.rows(made.seen)
    sticky = known.sticky
    if len(known) < FEWEST or not 10 <= sticky.sum() <= len(known) - 10:
        raise ValueError(f"{len(known)} of {loops} simulated loops show enough; give more loops, or a longer record")
    x = np.array([[shown[0][name] for name in known.names.tolist()] for _, shown in looks])
    travel = float(np.median([shown[1] for _, shown in looks]))  # in the unit of the record
    scale = travel if record.op_span is None else travel * 100.0 / (record.op_span[1] - record.op_span[0])
    unit = "OP units" if record.op_span is None else "%"
    own, mine = _opinions(known.x, known.names.tolist(), model), _opinions(x, known.names.tolist(), model)
    return replace(_read(known, x, own, mine, scale, unit, seen), seconds=time.perf_counter() - begun)


def split(record: LoopRecord) -> list[LoopRecord]:
    """Return the pieces that are looked at: the record itself, or up to ``PIECES`` of ``PIECE`` samples."""
    n = len(record)
    if n <= PIECE * 1.5:
        return [record]
    count = min(PIECES, n // PIECE)
    starts = np.linspace(0, n - PIECE, count).astype(int).tolist()
    return [replace(record, log=record.log.samples(a, a + PIECE)) for a in starts]


def simulated(specs: Sequence[LoopSpec], workers: int | None = None) -> Table:
    """Return features and truth of loops, made by several processes."""
    count = min(workers or os.cpu_count() or 1, max(1, len(specs) // 200))
    if count <= 1:
        return made_of(specs)
    shares = [list(specs[len(specs) * k // count : len(specs) * (k + 1) // count]) for k in range(count)]
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        tables = list(pool.map(made_of, shares))
    return Table.joined([one for one in tables if len(one.names)])


def made_of(specs: Sequence[LoopSpec]) -> Table:
    """Return features and truth of loops, in this process."""
    return table(simulate(specs, workers=1))


def _opinions(x: Floats, names: Sequence[str], model: Model | None) -> Floats:
    """Return what stage (a) says of features (n, f): log odds of causes, ln S and ln J; nothing without a model."""
    if model is None:
        return np.zeros((len(x), 0))
    own = x[:, [names.index(name) for name in model.names]]
    p, others = model.probabilities(own)
    causes = np.column_stack([_odds(p), np.log(np.maximum(others / np.maximum(1.0 - p, 1e-9)[:, None], 1e-4))])
    return np.hstack([causes, model.sizes(own, "S"), model.sizes(own, "J")])


def _measured(piece: LoopRecord) -> Conditions | None:
    try:
        return conditions(piece)
    except ValueError:
        return None


def _typical(seen: Sequence[Conditions]) -> Conditions:
    """Return the conditions of the piece whose period is the median."""
    return sorted(seen, key=lambda one: one.points)[len(seen) // 2]


def _read(known: Table, x: Floats, own: Floats, mine: Floats, scale: float, unit: str, seen: Conditions) -> AtRecord:
    """Return what the simulated loops say about features ``x`` (pieces, f); ``scale`` [unit] is the travel of OP.

    ``own`` and ``mine``: what stage (a) says of the loops and of the pieces.
    """
    cause = np.array([CAUSES.index(word) for word in known.truth["cause"].tolist()], dtype=np.intp)
    sticky = known.sticky
    scaled = Scaled.of(known.x)
    spread = np.maximum(own.std(axis=0), 1e-9)
    z = np.hstack([(own - own.mean(axis=0)) / spread, scaled(known.x)])
    at = np.hstack([(mine - own.mean(axis=0)) / spread, scaled(x)])
    free = own.shape[1] + 1
    size = np.where(sticky, known.truth["S"].astype(float) / known.unit, np.nan)  # in units of the travel of OP
    share = np.where(sticky, known.truth["J"].astype(float) / known.truth["S"].astype(float), np.nan)
    log_size, fold = np.log(size), folds(len(known))
    chance = np.zeros((len(known), len(CAUSES)))
    told = np.zeros((len(known), 2))
    for k in range(int(fold.max()) + 1):
        fit, test = fold != k, fold == k
        chance[test] = probabilities(logistic(z[fit], cause[fit], len(CAUSES), free=free), z[test])
        rest = fit & sticky
        told[test, 0] = z[test] @ ridge_fit(z[rest], log_size[rest], free=free)
        told[test, 1] = z[test] @ ridge_fit(z[rest], share[rest], free=free)
    pieces = probabilities(logistic(z, cause, len(CAUSES), free=free), at)
    mean = np.exp(np.log(np.maximum(pieces, 1e-12)).mean(axis=0))
    mean /= mean.sum()
    sizes_of = [ridge_fit(z[sticky], y[sticky], free=free) for y in (log_size, share)]
    here = np.array([np.median(at @ weights) for weights in sizes_of])
    odds = _odds(chance[:, STICTION])
    p = _platt(odds, sticky, _odds(mean[STICTION : STICTION + 1]))
    rest_of = (1.0 - p) / max(1.0 - float(mean[STICTION]), 1e-12)
    causes: dict[str, float] = {str(word): float(v) * rest_of for word, v in zip(CAUSES, mean, strict=True)}
    causes["stiction"] = p
    weights = nearest(told[sticky], here)
    sizes = scale * np.exp(weighted_quantile(log_size[sticky] - told[sticky, 0], weights, QUANTILES) + here[0])
    jumps = np.clip(weighted_quantile(share[sticky] - told[sticky, 1], weights, QUANTILES) + here[1], 0.02, 1.0)
    threshold = float(np.quantile(odds[~sticky], 1.0 - FALSE_ALARMS))
    curve = Curve.fitted(1.0 / size[sticky], odds[sticky] > threshold)
    least = curve.travel(CHANCE)
    limit = scale / least if least >= float(np.quantile(1.0 / size[sticky], 0.02)) else math.nan
    return AtRecord(
        probability=p, causes=causes, S=Amount(*_ordered(sizes), unit), J=Amount(*_ordered(sizes[1] * jumps), unit),
        detection_limit=limit, unit=unit, conditions=seen, loops=len(known),
        false_alarms=float((odds[~sticky] > threshold).mean()), area=_area(odds, sticky), seconds=0.0,
    )  # fmt: skip


def _odds(p: Floats) -> Floats:
    """Return log odds of probabilities."""
    safe = np.clip(p, 1e-9, 1.0 - 1e-9)
    return np.asarray(np.log(safe / (1.0 - safe)))


def _platt(odds: Floats, sticky: NDArray[np.bool_], mine: Floats) -> float:
    """Return the probability of stiction, calibrated on the loops that the fits had not seen (Platt 1999)."""
    z = np.column_stack([np.ones(len(odds)), odds])
    w = logistic(z, sticky.astype(np.intp), 2, ridge=1e-3)
    return float(probabilities(w, np.array([[1.0, float(mine[0])]]))[0, 1])


def _ordered(quantiles: Floats) -> tuple[float, float, float]:
    """Return value, low and high of the quantiles 5, 50 and 95 %."""
    return float(quantiles[1]), float(quantiles[0]), float(quantiles[2])


def _area(odds: Floats, sticky: NDArray[np.bool_]) -> float:
    """Return the area under the curve of hits over false alarms."""
    order = np.argsort(np.argsort(odds)) + 1.0
    n, m = int(sticky.sum()), int((~sticky).sum())
    return float((order[sticky].sum() - n * (n + 1) / 2) / (n * m))
