"""Fit a hypothesis: steps of Fisher's scoring in all that is free at once, each within its bounds.

    g_i = d nll / d x_i,   I_ij = sum over rows and signals of  d_i d_j / s + (d_i ln s)(d_j ln s) / 2
    x <- x - (I + lambda diag I)^-1 g                              within the bounds

d: slope of what is missed at a row; x: logarithm of a size whose range is logarithmic, unless 0 is neutral: then the
size in the middle of that range; else the size in its range.  Slopes in noise come from the filter's own slopes, those
in tolerances from runs with the filter's gains: neither needs a new filter, as the size of an effect does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.likelihood.hypothesis import ENDLESS, Hypothesis, Innovations

Floats = NDArray[np.float64]
ROUNDS = 6
PROBE = 2e-3  # of a coordinate, for its slope: well above the accuracy of a run
SETTLED = 0.1  # nats that a step must promise
FINER, SMALL = 2, 1.0  # times that a probe is made finer that moves an innovation by more standard deviations
STRAIGHT = 0.3  # share of its move that a probe of a tenth may leave of an innovation with a slope
FELT = 1e-3  # information of a parameter below which the record says nothing of it
WIDEST = 0.7  # largest change of a coordinate in one step


@dataclass(frozen=True, eq=False)
class Fit:
    """The best values of a hypothesis: ``best``, the free ``names`` that are felt, Fisher's information ``I`` of their
    coordinates, and the ``slopes`` of the innovations in them, (names, rows, signals).
    """

    best: Innovations
    names: tuple[str, ...]
    I: Floats
    slopes: Floats

    @property
    def nll(self) -> float:
        """Negative logarithm of the likelihood [nats]."""
        return self.best.nll

    @property
    def hypothesis(self) -> Hypothesis:
        """What was fitted."""
        return self.best.hypothesis

    @cached_property
    def sd(self) -> dict[str, float]:
        """Standard deviation of each parameter, in its unit."""
        spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(self.I)), 0.0)) if len(self.names) else np.zeros(0)
        one, values = self.hypothesis, self.best.values
        return {
            name: float(s) * (abs(values[name]) if logarithmic(one, name) else width(one, name))
            for name, s in zip(self.names, spread, strict=True)
        }


def unfitted(best: Innovations) -> Fit:
    """Return these values as they are, none of them known to be free."""
    return Fit(best, (), np.zeros((0, 0)), np.zeros((0, *best.e.shape)))


def logarithmic(one: Hypothesis, name: str) -> bool:
    """Return whether a parameter is fitted by its logarithm."""
    low, _ = one.bounds[name]
    if name in one.frame.free:
        return low > 0.0
    spaced = one.effect is not None and any(p.name == name and p.spacing == "log" for p in one.effect.parameters)
    return spaced and low > 0.0 and one.nominal[name] != 0.0


def width(one: Hypothesis, name: str) -> float:
    """Return the unit in which a parameter is fitted that is not fitted by its logarithm."""
    low, high = one.bounds[name]
    spaced = one.effect is not None and any(p.name == name and p.spacing == "log" for p in one.effect.parameters)
    return math.sqrt(low * high) if spaced and low > 0.0 else high - low


def tried(
    one: Hypothesis, values: Mapping[str, float], near: Innovations | None = None, most_runs: int = ENDLESS
) -> Innovations | None:
    """Return what these values leave; None if the effect cannot have them, a run fails, or it takes too many."""
    full = {**one.nominal, **values}
    if one.effect and one.effect.rules(one.frame.model, one.place, {name: full[name] for name in one.own}):
        return None
    try:
        found = one.filtered(full, near, most_runs=most_runs)
    except ArithmeticError:
        return None
    return found if math.isfinite(found.nll) else None


def refined(start: Innovations, names: Sequence[str], rounds: int = ROUNDS, near: Innovations | None = None) -> Fit:
    """Return the fit near a start; ``names`` of the parameters that are free.

    The start is what a filter of its own has left, or what was left with the gains of the filter ``near``, which stay.
    """
    now, damped = start, 1e-3
    g, information, felt, slopes = _slopes(now, names)
    for _ in range(rounds):
        if not felt:
            break
        moved = False
        for _ in range(4):
            d, promised = _step(now, felt, g, information, damped)
            if promised < SETTLED:
                break
            ahead = _at(now, felt, d, near)
            if ahead is not None and ahead.nll < now.nll - 1e-3:
                gained, now, moved, damped = now.nll - ahead.nll, ahead, True, max(0.2 * damped, 1e-4)
                break
            damped *= 12.0
        if not moved:
            break
        g, information, felt, slopes = _slopes(now, names)
        if gained < SETTLED:
            break
    return Fit(now, tuple(felt), information, slopes)


def _at(now: Innovations, names: Sequence[str], d: Floats, near: Innovations | None) -> Innovations | None:
    """Return what is left a step away."""
    one = now.hypothesis
    at = np.array([coordinate(one, name, now.values[name]) for name in names])
    values = {name: value(one, name, x) for name, x in zip(names, at + d, strict=True)}
    return tried(one, {**now.values, **values}, near)


def _slopes(now: Innovations, names: Sequence[str]) -> tuple[Floats, Floats, list[str], Floats]:
    """Return slope of the nll, Fisher's information, the parameters that are felt, and slopes of the innovations."""
    one, rows = now.hypothesis, now.hypothesis.frame.counted
    missed, spread, gradient, felt = [], [], [], []
    for name in names:
        if not math.isfinite(now.values[name]):
            continue
        at, high = coordinate(one, name, now.values[name]), coordinate(one, name, one.bounds[name][1])
        step, bent = PROBE if at + PROBE <= high else -PROBE, np.zeros(now.e.shape, dtype=np.bool_)
        if name in one.noise_keys:
            probe = one.noisier(now, {name: value(one, name, at + step)})
        else:
            found = _probed(now, name, at, step)
            if found is None:
                continue
            probe, step, bent = found
        d = np.where(bent, 0.0, np.nan_to_num((probe.missed - now.missed) / np.sqrt(now.S) / step))
        w = np.nan_to_num((np.log(probe.S) - np.log(now.S)) / step)
        e = np.nan_to_num(now.e)
        if float(np.sum(d[rows] ** 2) + 0.5 * np.sum(w[rows] ** 2)) < FELT:
            continue
        missed.append(d)
        spread.append(w)
        known = now.weights * e
        gradient.append(float(np.sum((known * d + 0.5 * w * (np.isfinite(now.e) - known * e))[rows])))
        felt.append(name)
    if not felt:
        return np.zeros(0), np.zeros((0, 0)), [], np.zeros((0, *now.e.shape))
    slopes, both = np.array(missed), np.array(spread)
    sure = np.sqrt(now.weights)
    D, V = ((x * sure)[:, rows].reshape(len(felt), -1) for x in (slopes, both))
    return np.array(gradient), D @ D.T + 0.5 * V @ V.T, felt, slopes


def _probed(now: Innovations, name: str, at: float, step: float) -> tuple[Innovations, float, NDArray[np.bool_]] | None:
    """Return what is left a small step away, the step, and which innovations it moves out of proportion."""
    one = now.hypothesis
    # an effect changes gains, which counts as long as innovations are large
    near = None if name in one.own and now.gross else now

    def stepped(step: float) -> Innovations | None:
        changed = {**now.values, name: value(one, name, at + step)}
        return tried(one, changed, near) or tried(one, changed)

    found, bent = stepped(step), np.zeros(now.e.shape, dtype=np.bool_)
    if found is None or not (now.kinks.any() or _far(now, found) > SMALL):
        return None if found is None else (found, step, bent)
    for _ in range(FINER):
        finer = stepped(0.1 * step)
        if finer is None:
            break
        bent = np.abs(finer.missed - now.missed) > STRAIGHT * np.abs(found.missed - now.missed)
        found, step = finer, 0.1 * step
    return found, step, bent


def _far(now: Innovations, probe: Innovations) -> float:
    """Return by how many standard deviations a probe moves the innovation that it moves most."""
    return float(np.nanmax(np.abs(probe.missed - now.missed) / np.sqrt(now.S), initial=0.0))


def _step(
    now: Innovations, names: Sequence[str], g: Floats, information: Floats, damped: float
) -> tuple[Floats, float]:
    """Return the step within bounds, and the nats that it promises."""
    from scipy.optimize import lsq_linear

    one = now.hypothesis
    at = np.array([coordinate(one, name, now.values[name]) for name in names])
    ends = np.array([[coordinate(one, name, end) for end in one.bounds[name]] for name in names])
    widest = WIDEST * np.maximum(
        1.0, [1.0 if logarithmic(one, name) else abs(x) for name, x in zip(names, at, strict=True)]
    )
    low = np.minimum(np.maximum(ends[:, 0] - at, -widest), -1e-12)
    high = np.maximum(np.minimum(ends[:, 1] - at, widest), 1e-12)
    A = information + damped * np.diag(np.diag(information)) + 1e-12 * np.eye(len(g)) * np.trace(information)
    root = np.linalg.cholesky(A).T
    d = np.asarray(lsq_linear(root, np.linalg.solve(root.T, -g), (low, high)).x)
    return d, -float(g @ d + 0.5 * d @ information @ d)


def coordinate(one: Hypothesis, name: str, size: float) -> float:
    """Return the coordinate of a size of a parameter."""
    low, high = one.bounds[name]
    size = float(np.clip(size, low, high))
    return math.log(size) if logarithmic(one, name) else size / width(one, name)


def value(one: Hypothesis, name: str, x: float) -> float:
    """Return the size of a parameter at a coordinate, within its bounds."""
    size = math.exp(x) if logarithmic(one, name) else x * width(one, name)
    return float(np.clip(size, *one.bounds[name]))
