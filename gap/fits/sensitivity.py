"""What the size of an effect does to the score, from one replay near neutral: what it promises, what would be seen.

    e(s) = e + J s                   innovations with a small effect of size s in the model, J their slopes at neutral
    promised = F(e) - min F(e + J s)
    seen     the least s with  F(e - J s) - F(e) >= nats        (the effect in the log instead)

Effects that have no slope at neutral (a limit, a stem that sticks) are replayed at sizes over their range instead.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.gap.answers.seen import Seen
from stickslip.gap.fits.robust import step
from stickslip.gap.fits.search import Candidate, slopes
from stickslip.gap.floors.floor import losses
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

Floats = NDArray[np.float64]
STEPS, NEAR = 12, 0.02  # secants until the nats are met within this share
SIZES = 10  # sizes that are replayed where there is no slope
HALF = 0.5  # second size of a hidden effect, as a share of the first: the jump of a stem that sticks


def promised(candidate: Candidate) -> float:
    """Return how far the score falls along the slope of an effect at its neutral value; infinite without slopes."""
    absent = candidate.absent
    J, felt = trace(candidate)
    if not felt:
        return math.inf
    at = np.array([absent.values[name] for name in felt])
    low, high = np.array([candidate.bounds[name] for name in felt]).T
    return absent.F - step(absent.e.ravel(), J, np.minimum(low - at, 0.0), np.maximum(high - at, 0.0))[1]


def trace(candidate: Candidate) -> tuple[Floats, list[str]]:
    """Return (J, names): the slopes of the innovations near neutral, (values, parameters), for those that are felt.

    Of a load whose time is free, the one in the middle of the record: a step at its start is an offset.
    """
    return _trace(candidate.problem.quick, candidate.base, candidate.effect, candidate.place)


@lru_cache(maxsize=128)  # a whole catalogue: what screens it says in the end what would have been seen
def _trace(problem: Problem, base: Diagram, effect: Effect | None, place: str) -> tuple[Floats, list[str]]:
    candidate = Candidate(problem, base, effect, place)
    absent = candidate.absent
    if "time" in candidate.own:
        t = candidate.problem.record.log.t
        absent = replace(absent, values={**absent.values, "time": float(t[len(t) // 2])})
    return slopes(absent)


def smallest(candidate: Candidate, nats: float) -> Seen | None:
    """Return the smallest size of an effect whose trace in the log raises the score by ``nats``; None if none does."""
    effect = candidate.effect
    if effect is None or effect.of_log or not candidate.sizes:
        return None
    main = next(p for p in effect.parameters if p.name == candidate.sizes[0])
    found = _of_noise(candidate, nats) if candidate.noisy else _of_slope(candidate, nats)
    if found is None:
        found = _of_sizes(replace(candidate, problem=candidate.problem.quick), nats)
    return None if found is None else Seen(effect.name, candidate.place, main.name, found, main.unit)


def _of_slope(candidate: Candidate, nats: float) -> float | None:
    name, absent = candidate.sizes[0], candidate.absent
    if candidate.effect is None or candidate.effect.hidden or not math.isfinite(candidate.nominal[name]):
        return None
    J, felt = trace(candidate)
    if name not in felt:
        return None
    low, high = candidate.bounds[name]
    most = max(high - candidate.nominal[name], candidate.nominal[name] - low)
    return _least(absent.e.ravel(), -J[:, felt.index(name)], candidate.nominal[name], most, nats)


def _least(e: Floats, J: Floats, nominal: float, most: float, nats: float) -> float | None:
    """Return nominal + s for the least s with F(e + J s) - F(e) = nats, by secants; None above ``most``.

    Near neutral F grows as s^2, later as its logarithm.
    """
    F, size = float(losses(e).sum()), float(np.nansum(J**2))
    if not size > 0.0:
        return None
    s = math.sqrt(2.0 * nats / size)
    for _ in range(STEPS):
        gained = max(float(losses(e + J * s).sum()) - F, 1e-3 * nats)
        s *= math.sqrt(nats / gained)
        if abs(gained / nats - 1.0) < NEAR:
            break
    return nominal + s if s <= most else None


def _of_noise(candidate: Candidate, nats: float) -> float | None:
    e = candidate.absent.e
    pinned = candidate.problem.record.pinned
    columns = [pinned.index(str(s)) for s in candidate.base[candidate.place].output_labels if s in pinned]
    own, n = e[:, columns], float(np.isfinite(e[:, columns]).sum())
    F = float(losses(own).sum())
    for factor in np.geomspace(1.0, candidate.bounds["factor"][1], 400)[1:].tolist():
        if float(losses(own * factor).sum()) - F - n * math.log(factor) >= nats:  # what a fit of the factor gains
            return float(factor)
    return None


def _of_sizes(candidate: Candidate, nats: float) -> float | None:
    """Return the size, between two that are replayed, at which the score has gone up by ``nats``."""
    name = candidate.sizes[0]
    low, high = candidate.bounds[name]
    if not 0.0 < low < high < math.inf:
        return None
    grid = np.geomspace(low, high, SIZES)
    if candidate.nominal[name] > high:  # the larger, the less there is of it
        grid = grid[::-1]
    second = candidate.sizes[1:] if candidate.effect is not None and candidate.effect.hidden else ()
    fits = candidate.tried([{name: float(s), **dict.fromkeys(second, HALF * float(s))} for s in grid])
    before, gained = grid[0], 0.0
    for fit in fits:
        size, more = fit.values[name], fit.F - candidate.absent.F
        if more >= nats:
            share = (nats - gained) / (more - gained)
            return float(before * (size / before) ** share)
        before, gained = size, max(more, 0.0)
    return None


def seen(legal: Sequence[Candidate], nats: float) -> tuple[Seen, ...]:
    """Return for each effect at each place from what size on the record would have shown it."""
    return tuple(found for one in legal if (found := smallest(one, nats)) is not None)
