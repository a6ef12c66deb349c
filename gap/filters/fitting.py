"""Fit an explanation by its likelihood: sizes over the whole range first, then steps of Fisher's scoring.

    g_i = d nll / d x_i,   I_ij = sum over rows and signals of  d_i d_j / s + (d_i ln s)(d_j ln s) / 2
    x <- x - (I + lambda diag I)^-1 g                              within the bounds

d: slope of what is missed at a row; x: logarithm of a size whose range is logarithmic, unless 0 is neutral: then the
size in the middle of that range, since what a small size does grows with it; else the size in its range.
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

Floats = NDArray[np.float64]
ROUNDS = 10
PROBE = 1e-4  # of a coordinate, for its slope
SETTLED = 0.1  # nats that a step must promise
NEARBY = (0.05, 0.2, 0.6)  # changes of a factor that are looked at first
NODES = 6  # sizes of a parameter that are looked at first
WIDEST = 0.7  # largest change of a coordinate in one step


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
        spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(self.I)), 0.0)) if len(self.names) else np.zeros(0)
        one = self.best.explanation
        return {
            name: float(s) * (abs(self.best.values[name]) if logarithmic(one, name) else width(one, name))
            for name, s in zip(self.names, spread, strict=True)
        }


def spread(one: Explanation, name: str) -> bool:
    """Return whether the range of a parameter is logarithmic."""
    if name in one.filtering.free:
        return one.bounds[name][0] > 0.0
    return any(p.name == name and p.spacing == "log" for p in one.effect.parameters) if one.effect else False


def logarithmic(one: Explanation, name: str) -> bool:
    """Return whether a parameter is fitted by its logarithm."""
    return spread(one, name) and one.nominal[name] != 0.0


def width(one: Explanation, name: str) -> float:
    """Return the unit in which a parameter is fitted that is not fitted by its logarithm."""
    low, high = one.bounds[name]
    return math.sqrt(low * high) if spread(one, name) else high - low


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
        at, low, high = (np.array(v) for v in zip(*(_coordinates(one, name, now.values) for name in felt), strict=True))
        moved = False
        for _ in range(4):
            widest = WIDEST * np.array(
                [1.0 if logarithmic(one, name) else max(1.0, x) for name, x in zip(felt, at, strict=True)]
            )
            d, promised = _step(g, information, damped, np.maximum(low - at, -widest), np.minimum(high - at, widest))
            if promised < SETTLED:
                break
            ahead = tried(one, {**now.values, **_values(one, felt, at + d)})
            if ahead is not None and ahead.nll < now.nll - 1e-3:
                gained, now, moved, damped = now.nll - ahead.nll, ahead, True, max(0.2 * damped, 1e-4)
                break
            damped *= 12.0
        if not moved or gained < SETTLED:
            break
    return Found(now, tuple(felt), information)


def _slopes(now: Filtered, names: Sequence[str]) -> tuple[Floats, Floats, list[str]]:
    """Return slope of the nll, Fisher's information and the names of the parameters that are felt."""
    one, rows = now.explanation, now.explanation.filtering.counted
    missed, spread, gradient, felt, steps = [], [], [], [], []
    for name in names:
        at, _, high = _coordinates(one, name, now.values)
        step = PROBE if at + PROBE <= high else -PROBE
        probe = tried(one, {**now.values, **_values(one, [name], np.array([at + step]))})
        if probe is None:
            continue
        d = (probe.e * np.sqrt(probe.S) - now.e * np.sqrt(now.S))[rows] / np.sqrt(now.S[rows]) / step
        w = (np.log(probe.S) - np.log(now.S))[rows] / step
        d, w = np.nan_to_num(d).ravel(), np.nan_to_num(w).ravel()
        if float(d @ d + 0.5 * (w @ w)) < 1e-6:
            continue
        missed.append(d)
        spread.append(w)
        gradient.append((probe.nll - now.nll) / step)
        felt.append(name)
        steps.append(step)
    if not felt:
        return np.zeros(0), np.zeros((0, 0)), []
    D, W = np.array(missed), np.array(spread)
    information = D @ D.T + 0.5 * W @ W.T
    # a slope from one side is off by half the curvature times the probe
    g = np.array(gradient) - 0.5 * np.diag(information) * np.array(steps)
    return g, information, felt


def directions(now: Filtered) -> dict[str, Floats]:
    """Return parameter -> how the innovations change with it, (rows, signals); what is not felt is left out."""
    one, found = now.explanation, {}
    for name in (*one.own, *one.filtering.free):
        if not math.isfinite(now.values[name]):
            continue
        at, _, high = _coordinates(one, name, now.values)
        step = PROBE if at + PROBE <= high else -PROBE
        probe = tried(one, {**now.values, **_values(one, [name], np.array([at + step]))})
        if probe is not None:
            d = np.nan_to_num((probe.e * np.sqrt(probe.S) - now.e * np.sqrt(now.S)) / np.sqrt(now.S) / step)
            if float(np.sum(d**2)) > 1.0:
                found[name] = d
    return found


def _step(g: Floats, information: Floats, damped: float, low: Floats, high: Floats) -> tuple[Floats, float]:
    """Return the step within bounds, and the nats that it promises; what wants to leave its bounds stays at them."""
    n = len(g)
    A = information + damped * np.diag(np.diag(information))
    held = ((low >= -1e-12) & (g > 0.0)) | ((high <= 1e-12) & (g < 0.0))
    d = np.zeros(n)
    for _ in range(n):
        loose = np.flatnonzero(~held)
        if len(loose) == 0:
            break
        d = np.zeros(n)
        fixed = np.flatnonzero(held)
        ends = np.where(g[fixed] > 0.0, low[fixed], high[fixed])
        d[fixed] = np.where(np.abs(ends) < 1e-12, 0.0, ends)
        d[loose] = np.linalg.solve(A[np.ix_(loose, loose)], -g[loose] - A[np.ix_(loose, fixed)] @ d[fixed])
        out = loose[(d[loose] < low[loose] - 1e-12) | (d[loose] > high[loose] + 1e-12)]
        if len(out) == 0:
            break
        worst = out[np.argmax(np.maximum(low[out] - d[out], d[out] - high[out]))]
        d[worst] = np.clip(d[worst], low[worst], high[worst])
        g = g.copy()
        held[worst] = True
        low, high = low.copy(), high.copy()
        low[worst] = high[worst] = d[worst]
    d = np.clip(d, low, high)
    return d, -float(g @ d + 0.5 * d @ information @ d)


def _coordinates(one: Explanation, name: str, values: Mapping[str, float]) -> tuple[float, float, float]:
    """Return (coordinate, its lowest, its highest) of a parameter."""
    low, high = one.bounds[name]
    value = float(np.clip(values[name], low, high))
    if logarithmic(one, name):
        return math.log(value), math.log(low), math.log(high)
    unit = width(one, name)
    return value / unit, low / unit, high / unit


def _values(one: Explanation, names: Sequence[str], x: Floats) -> dict[str, float]:
    """Return parameters from coordinates."""
    found = {}
    for name, one_x in zip(names, x.tolist(), strict=True):
        low, high = one.bounds[name]
        value = math.exp(one_x) if logarithmic(one, name) else one_x * width(one, name)
        found[name] = float(np.clip(value, low, high))
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
