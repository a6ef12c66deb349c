"""Fit a hypothesis: steps of Fisher's scoring in all that is free at once, each within its bounds.

    g_i = d nll / d x_i,   I_ij = sum over rows and signals of  d_i d_j / s + (d_i ln s)(d_j ln s) / 2
    x <- x - (I + lambda diag I)^-1 g                              within the bounds

d: slope of what is missed at a row; x: logarithm of a size whose range is logarithmic, unless 0 is neutral: then the
size in the middle of that range; else the size in its range.  Slopes in noise come from the filter's own slopes, those
in tolerances from runs with the filter's gains: neither needs a new filter, as the size of an effect does.

What is known within a tolerance is as likely anywhere in it: a fit is drawn to its middle by a normal law of the same
variance, a twelfth of the square of its width.  A record that tells nothing of it leaves it there.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.coordinates import coordinate, moved, spreads, step, value
from stickslip.gap.likelihood.hypothesis import ENDLESS, Hypothesis, Innovations
from stickslip.logs.arrays import Values

ROUNDS = 6
PROBE = 2e-3  # of a coordinate, for its slope: well above the accuracy of a run
SETTLED = 0.1  # nats that a step must promise
FINER, SMALL = 2, 1.0  # times that a probe is made finer that moves an innovation by more standard deviations
STRAIGHT = 0.3  # share of its move that a probe of a tenth may leave of an innovation with a slope
FELT = 1e-3  # information of a parameter below which the record says nothing of it


@dataclass(frozen=True, eq=False)
class Fit:
    """The best values of a hypothesis: ``best``, the free ``names`` that are felt, Fisher's information ``I`` of their
    coordinates, and the ``slopes`` of the innovations in them, (names, rows, signals).
    """

    best: Innovations
    names: tuple[str, ...]
    I: Values
    slopes: Values

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
        return spreads(self.hypothesis, self.names, self.best.values, self.I)


def unfitted(best: Innovations) -> Fit:
    """Return these values as they are, none of them known to be free."""
    return Fit(best, (), np.zeros((0, 0)), np.zeros((0, *best.e.shape)))


def tried(
    one: Hypothesis,
    values: Mapping[str, float],
    near: Innovations | None = None,
    most_runs: int = ENDLESS,
    best: Innovations | None = None,
) -> Innovations | None:
    """Return what these values leave; None if the effect cannot have them, a run fails, it takes too many, or the
    ``best`` of the same rows is far ahead.
    """
    full = {**one.nominal, **values}
    if _ruled_out(one, full):
        return None
    try:
        found = one.filtered(full, near, most_runs=most_runs, best=best)
    except ArithmeticError:
        return None
    return found if math.isfinite(found.nll) else None


def all_at_once(one: Hypothesis, many: Sequence[Mapping[str, float]]) -> list[Innovations | None]:
    """Return what replays of many sets of values leave, which takes less than one after another."""
    legal = [values for values in many if not _ruled_out(one, {**one.nominal, **values})]
    return [found if found is not None and math.isfinite(found.nll) else None for found in one.replayed(legal)]


def _ruled_out(one: Hypothesis, values: Mapping[str, float]) -> bool:
    """Return whether an effect cannot have these values."""
    own = {name: values[name] for name in one.own}
    return one.effect is not None and bool(one.effect.rules(one.frame.model, one.place, own))


def refined(start: Innovations, names: Sequence[str], rounds: int = ROUNDS, near: Innovations | None = None) -> Fit:
    """Return the fit near a start; ``names`` of the parameters that are free.

    The start is what a filter of its own has left, or what was left with the gains of the filter ``near``, which stay.
    """
    now, damped = start, 1e-3
    g, information, felt, slopes = _slopes(now, names)
    for _ in range(rounds):
        if not felt:
            break
        gained = 0.0
        for _ in range(4):
            d, promised = step(now.hypothesis, felt, now.values, g, information, damped)
            if promised < SETTLED:
                break
            ahead = _at(now, felt, d, near)
            if ahead is not None and _loss(ahead) < _loss(now) - 1e-3:
                gained, now, damped = _loss(now) - _loss(ahead), ahead, max(0.2 * damped, 1e-4)
                break
            damped *= 12.0
        if gained == 0.0:
            break
        g, information, felt, slopes = _slopes(now, names)
        if gained < SETTLED:
            break
    return Fit(now, tuple(felt), information, slopes)


def _at(now: Innovations, names: Sequence[str], d: Values, near: Innovations | None) -> Innovations | None:
    """Return what is left a step away."""
    one = now.hypothesis
    return tried(one, {**now.values, **moved(one, names, now.values, d)}, near, best=now)


def _slopes(now: Innovations, names: Sequence[str]) -> tuple[Values, Values, list[str], Values]:
    """Return slope of the nll, Fisher's information, the parameters that are felt, and slopes of the innovations."""
    one, rows = now.hypothesis, now.hypothesis.frame.counted
    missed, spread, gradient, felt = [], [], [], []
    replays = _replayed(now, names) if one.frame.replays else {}
    for name in names:
        if not math.isfinite(now.values[name]):
            continue
        at, high = coordinate(one, name, now.values[name]), coordinate(one, name, one.bounds[name][1])
        by, bent = _aside(at, high), np.zeros(now.e.shape, dtype=np.bool_)
        if one.frame.replays:
            known_probe = replays.get(name)
            if known_probe is None:
                continue
            probe = known_probe
        elif name in one.noise_keys or _makes_noise(now, name):
            probe = one.noisier(now, {name: value(one, name, at + by)})
        else:
            found = _probed(now, name, at, by)
            if found is None:
                continue
            probe, by, bent = found
        d = np.where(bent, 0.0, np.nan_to_num((probe.missed - now.missed) / np.sqrt(now.S) / by))
        w = np.nan_to_num((np.log(probe.S) - np.log(now.S)) / by)
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
    _, pull, hold = _drawn(now)
    g = np.array(gradient) + [pull.get(name, 0.0) for name in felt]
    return g, D @ D.T + 0.5 * V @ V.T + np.diag([hold.get(name, 0.0) for name in felt]), felt, slopes


def _makes_noise(now: Innovations, name: str) -> bool:
    """Return whether a parameter of an effect only makes random numbers larger: with the same gains nothing moves."""
    one = now.hypothesis
    if one.effect is None or name not in one.own:
        return False
    own = {key: now.values[key] for key in one.own}
    return one.effect.settings(one.frame.model, one.place, **own).keys() <= one.noise_keys


def _aside(at: float, high: float) -> float:
    """Return by how much a coordinate is changed to see its slope."""
    return PROBE if at + PROBE <= high else -PROBE


def _replayed(now: Innovations, names: Sequence[str]) -> dict[str, Innovations | None]:
    """Return replays with each parameter a little aside, all at once."""
    one, many = now.hypothesis, {}
    for name in names:
        if math.isfinite(now.values[name]):
            at, high = coordinate(one, name, now.values[name]), coordinate(one, name, one.bounds[name][1])
            ahead = {**now.values, name: value(one, name, at + _aside(at, high))}
            if not _ruled_out(one, ahead):
                many[name] = ahead
    return dict(zip(many, one.replayed(list(many.values())), strict=True))


def _loss(now: Innovations) -> float:
    """Return what values lose by the record and by what is known within a tolerance [nats]."""
    return now.nll + _drawn(now)[0]


def _drawn(now: Innovations) -> tuple[float, dict[str, float], dict[str, float]]:
    """Return what tolerances say against values [nats], and its slope and bend in the coordinate of each."""
    one, lost, pull, hold = now.hypothesis, 0.0, {}, {}
    for name in one.frame.given.base.unsure:
        low, high = (coordinate(one, name, end) for end in one.bounds[name])
        away = coordinate(one, name, now.values[name]) - 0.5 * (low + high)
        hold[name] = 12.0 / (high - low) ** 2
        pull[name] = hold[name] * away
        lost += 0.5 * pull[name] * away
    return lost, pull, hold


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
