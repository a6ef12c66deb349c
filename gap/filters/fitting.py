"""Fit an explanation by its likelihood: sizes over the whole range first, then steps of Fisher's scoring.

    g_i = d nll / d x_i,   I_ij = sum over rows and signals of  d_i d_j / s + (d_i ln s)(d_j ln s) / 2
    x <- x - (I + lambda diag I)^-1 g                              within the bounds

d: slope of what is missed at a row; x: coordinates of the sizes (``gap.fits.coordinates``).
Parameters of the model with a tolerance are free in every fit, within it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.filters.affine import NotAffine
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.fits.coordinates import coordinate, moved, spread, spreads, step

Floats = NDArray[np.float64]
ROUNDS = 10
PROBE = 1e-4  # of a coordinate, for its slope
SETTLED = 0.1  # nats that a step must promise
NEARBY = (0.05, 0.2, 0.6)  # changes of a factor that are looked at first
NODES = 6  # sizes of a parameter that are looked at first


@dataclass(frozen=True, eq=False)
class Found:
    """The best values of an explanation: ``best``, and Fisher's information ``I`` of the coordinates ``names``."""

    best: Filtered
    names: tuple[str, ...]
    I: Floats

    @property
    def nll(self) -> float:
        """Negative log likelihood."""
        return self.best.nll

    @cached_property
    def sd(self) -> dict[str, float]:
        """Standard deviation of each parameter, in its unit."""
        return spreads(self.best.explanation, self.names, self.best.values, self.I)


def tried(one: Explanation, values: Mapping[str, float]) -> Filtered | None:
    """Return what these values leave; None if they are none that the effect can have, or no filter has them."""
    full = {**one.nominal, **values}
    if one.effect and one.effect.rules(one.filtering.model, one.place, {name: full[name] for name in one.own}):
        return None
    try:
        found = one.filtered(full)
    except (NotAffine, np.linalg.LinAlgError):
        return None
    return found if math.isfinite(found.nll) else None


def refined(start: Filtered, names: Sequence[str], rounds: int = ROUNDS) -> Found:
    """Return the fit near a start; ``names`` of the parameters that are free."""
    one, now = start.explanation, start
    information = np.zeros((0, 0))
    damped, felt = 1e-3, list(names)
    for _ in range(rounds):
        g, information, felt = _slopes(now, felt)
        if not felt:
            break
        gained = 0.0
        for _ in range(4):
            d, promised = step(one, felt, now.values, g, information, damped)
            if promised < SETTLED:
                break
            ahead = tried(one, {**now.values, **moved(one, felt, now.values, d)})
            if ahead is not None and ahead.nll < now.nll - 1e-3:
                gained, now, damped = now.nll - ahead.nll, ahead, max(0.2 * damped, 1e-4)
                break
            damped *= 12.0
        if gained < SETTLED:
            break
    return Found(now, tuple(felt), information)


def _slopes(now: Filtered, names: Sequence[str]) -> tuple[Floats, Floats, list[str]]:
    """Return slope of the nll, Fisher's information and the names of the parameters that are felt."""
    one, rows = now.explanation, now.explanation.filtering.counted
    missed, spread, gradient, felt, steps = [], [], [], [], []
    for name in names:
        by = _probe(one, name, now.values)
        probe = tried(one, {**now.values, **moved(one, [name], now.values, np.array([by]))})
        if probe is None:
            continue
        d = (probe.e * np.sqrt(probe.S) - now.e * np.sqrt(now.S))[rows] / np.sqrt(now.S[rows]) / by
        w = (np.log(probe.S) - np.log(now.S))[rows] / by
        d, w = np.nan_to_num(d).ravel(), np.nan_to_num(w).ravel()
        if float(d @ d + 0.5 * (w @ w)) < 1e-6:
            continue
        missed.append(d)
        spread.append(w)
        gradient.append((probe.nll - now.nll) / by)
        felt.append(name)
        steps.append(by)
    if not felt:
        return np.zeros(0), np.zeros((0, 0)), []
    D, W = np.array(missed), np.array(spread)
    information = D @ D.T + 0.5 * W @ W.T
    # a slope from one side is off by half the curvature times the probe
    g = np.array(gradient) - 0.5 * np.diag(information) * np.array(steps)
    return g, information, felt


def _probe(one: Explanation, name: str, values: Mapping[str, float]) -> float:
    """Return by how much a coordinate is moved for a slope: upwards, but not beyond its bound."""
    at, high = coordinate(one, name, values[name]), coordinate(one, name, one.bounds[name][1])
    return PROBE if at + PROBE <= high else -PROBE


def directions(now: Filtered) -> dict[str, Floats]:
    """Return parameter -> how the innovations change with it, (rows, signals); what is not felt is left out."""
    one, found = now.explanation, {}
    for name in (*one.own, *one.filtering.free):
        if not math.isfinite(now.values[name]):
            continue
        by = _probe(one, name, now.values)
        probe = tried(one, {**now.values, **moved(one, [name], now.values, np.array([by]))})
        if probe is not None:
            d = np.nan_to_num((probe.e * np.sqrt(probe.S) - now.e * np.sqrt(now.S)) / np.sqrt(now.S) / by)
            if float(np.sum(d**2)) > 1.0:
                found[name] = d
    return found


def grid(one: Explanation, name: str) -> list[float]:
    """Return sizes of a parameter to look at first: evenly in their logarithm, or to both sides of neutral."""
    low, high = one.bounds[name]
    nominal = one.nominal[name]
    if spread(one, name):
        if low < nominal < high < math.inf:
            near = [nominal * math.exp(way * by) for by in NEARBY for way in (1.0, -1.0)]
            return [size for size in near if low <= size <= high]
        return [float(v) for v in np.geomspace(low, high, NODES) if v != nominal]
    share = np.geomspace(0.02, 0.8, NODES // 2)
    return [*(nominal + share * (high - nominal)).tolist(), *(nominal + share * (low - nominal)).tolist()]


def best_of(found: Sequence[Filtered | None]) -> Filtered | None:
    """Return the likeliest, None if there is none."""
    return min((one for one in found if one is not None), key=lambda one: one.nll, default=None)
