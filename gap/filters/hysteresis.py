"""Fit stiction or a deadband with a bank of stems: a grid over the sizes, then patterns around the best, ever smaller.

The model's unsure parameters and the switches of its inputs start as the model without friction has them, and move with
the sizes.  What a stem gains is counted from a bank whose stems do not stick: its many paths suit any record that the
model does not better than a single filter does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.effects.stiction import Stiction
from stickslip.gap.filters import kalman, stems
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import Found
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.inserted import percent_in

Floats = NDArray[np.float64]
FEW, MANY = 20, 48  # stems of the grid and of the fit
SHARES = (0.3, 0.55, 0.8)  # of J in S that are tried
NEAR = ((1.0, 0.15), (1.12, 0.15), (1.12, 0.35), (1.3, 0.35))  # S over the width of the best deadband, J over S
REPEATS = 0.05  # standard deviation of the breakaway from stem to stem of a bank, as a share
SIZES = 9  # widths that are tried
SHARES_MOVING = 6  # of the scans at which a stem moves, whose gains are worked out
LATELY = 1.0  # rows over which that share is taken
NOTHING = 0.02  # [%], a width at which nothing sticks
SMALLEST, LARGEST = 0.25, 15.0  # [%], of S
FINEST = 0.008  # relative size of the last pattern
ROUNDS = 16
UNSURE = 0.3  # of the tolerance of a parameter of the model: its first step
SHRINKS, LEAST = 0.4, 0.1  # of a step that was wrong to both sides; nats that a step must gain
AT_BOUND = 1e-3  # of a range
SHOWN = 6.5  # nats by which a width has to be less likely than none, to be excluded
JUMPS = 0.3  # of S: a jump that no deadband has
DECIDED = 60.0  # nats by which few stems decide between stiction and deadband


@dataclass(frozen=True, eq=False)
class Bank:
    """The random numbers of a bank: the same for all sizes."""

    draws: Floats
    turns: Floats
    repeats: Floats

    @classmethod
    def of(cls, scans: int, rows: int, count: int, seed: int = 0) -> "Bank":
        """Return numbers for so many scans, rows and stems."""
        rng = np.random.default_rng([seed, count])
        draws, turns = rng.normal(size=(scans, count)), rng.random(rows)
        return cls(draws, turns, 1.0 + REPEATS * rng.normal(size=count))


def banked(one: Explanation, values: Mapping[str, float], bank: Bank) -> Filtered:
    """Return what a bank of stems of these sizes leaves."""
    f = one.filtering
    full = {**one.nominal, **values}
    percent = percent_in(f.quiet, one.place)
    S = full["width"] * percent if isinstance(one.effect, Deadband) else full["S"] * percent
    J = 0.0 if isinstance(one.effect, Deadband) else full["J"] * percent
    m = one.matrices(full)
    n, kinds = m.n, len(f.signals)
    if m.told is None:
        raise ValueError("a bank needs a cut at the valve")
    U = np.column_stack([f.played, f.time, np.ones(f.scans), np.zeros(f.scans)])
    A, K, s = np.empty((n, n)), np.zeros((SHARES_MOVING, kinds, n)), np.ones((SHARES_MOVING, kinds))
    for k in range(SHARES_MOVING):  # a stem that follows OP closes the loop
        kalman.closed(m.F, m.free, m.told, n, k / (SHARES_MOVING - 1), True, A)
        stems.settled_gains(A, m.Q, m.shown, f.r, f.every, K[k], s[k])
    moves = int(np.argmax(np.abs(m.told[n : n + len(m.v)])))
    jitter = stems.unsure(m.Q, m.free[moves][:n])
    e, loss, path = np.empty(f.Y.shape), np.empty(len(f.Y)), np.empty(len(f.Y))
    stems.banked(
        m.F, m.v, m.told, m.H, m.limits, m.memory, m.of, m.beyond, m.last, m.start, U, f.Y, f.acts, moves, f.every, K,
        s, 1.0 / (LATELY * f.every), jitter, S, J, bank.draws, bank.turns, bank.repeats, e, loss, path,
    )  # fmt: skip
    e = stems.deviates(e)
    return Filtered(one, full, e, np.where(np.isnan(e), np.nan, 1.0), path, loss)


@dataclass(frozen=True, eq=False)
class Looked:
    """A rough search with few stems at a ``place``: ``none`` is the negative log likelihood without sticking, ``flat``
    those of deadbands of growing width.
    """

    place: str
    none: float
    flat: Sequence[Filtered]

    @property
    def gained(self) -> float:
        """Nats by which the likeliest deadband is ahead of a stem that does not stick."""
        return self.none - min(one.nll for one in self.flat)

    @property
    def hidden(self) -> float:
        """The width [% OP] from which on the record excludes a deadband, the widest that was tried if it excludes none.

        Of narrower ones a bank knows too little: at 0.25 % it says 17 to 24 nats against a deadband that is there.
        """
        least = min(self.none, min(one.nll for one in self.flat))
        found = 0.0
        for one in self.flat:
            found = one.values["width"]
            if one.nll > least + SHOWN:
                break
        return found


def looked_at(plain: Found, place: str) -> Looked:
    """Return what few stems say of deadbands of the valve at a place; ``plain`` the model as it is, settled."""
    f = plain.best.explanation.filtering
    one, few = Explanation(f, Deadband(), place), Bank.of(f.scans, len(f.Y), FEW)
    free = {key: _inside(plain.best, key) for key in f.free}
    widths = np.geomspace(SMALLEST, LARGEST, SIZES).tolist()
    none, *flat = [banked(one, {**free, "width": width}, few) for width in (NOTHING, *widths)]
    return Looked(place, none.nll, flat)


def _inside(one: Filtered, key: str) -> float:
    """Return a parameter of a fit; nominal where it stopped at a bound: then the fit is of something else."""
    value, (low, high) = one.values[key], one.explanation.filtering.free[key]
    return one.explanation.nominal[key] if min(value - low, high - value) < AT_BOUND * (high - low) else value


def fitted_stems(looked: Looked, effects: Sequence[Effect], needed: float) -> list[Found]:
    """Return the best sizes of a deadband and of stiction where a catalogue has them, the likeliest first; none where
    few stems do not gain ``needed`` nats.
    """
    f, place = looked.flat[0].explanation.filtering, looked.place
    few, many = (Bank.of(f.scans, len(f.Y), count) for count in (FEW, MANY))
    stiction = next((effect for effect in effects if isinstance(effect, Stiction)), None)
    sharp: list[Filtered] = []
    if stiction is not None:
        one = Explanation(f, stiction, place)
        sharp = [_jumping(one, flat, 1.0, share, few) for flat in looked.flat for share in SHARES]
    if looked.none - min(one.nll for one in (*looked.flat, *sharp)) < needed:
        return []
    play, stuck = min(looked.flat, key=lambda one: one.nll), None
    if sharp:
        near = [_jumping(sharp[0].explanation, play, by, share, few) for by, share in NEAR]
        stuck = _followed(min((*sharp, *near), key=lambda one: one.nll), few, 0.15, 0.02)
        stuck = _followed(stuck, few, 0.08, 0.02)  # from there once more: a bank's likelihood is not quite smooth
    if stuck is None or stuck.values["J"] < JUMPS * stuck.values["S"] or play.nll < stuck.nll + DECIDED:
        play = _followed(play, few, 0.25, 0.06)
    found = []
    ahead = play.nll - stuck.nll if stuck is not None else 0.0  # of the deadband
    if any(isinstance(effect, Deadband) for effect in effects):
        found.append(
            _followed(play, many, 0.06, FINEST) if ahead < DECIDED else banked(play.explanation, play.values, many)
        )
    if stuck is not None and (ahead > 0.0 or not found):
        sure = ahead > DECIDED or not found  # what is not is followed by another bank (``jumping``)
        found.append(_followed(stuck, many, 0.08, FINEST) if sure else banked(stuck.explanation, stuck.values, many))
    return sorted((Found(one, (), np.zeros((0, 0))) for one in found), key=lambda one: one.nll)


def _jumping(one: Explanation, flat: Filtered, by: float, share: float, bank: Bank) -> Filtered:
    """Return a stem whose S is so many times a deadband's width, and whose J is a share of S."""
    S = by * flat.values["width"]
    free = {key: flat.values[key] for key in one.filtering.free}
    return banked(one, {**free, "S": S, "J": share * S}, bank)


def followed_on(start: Filtered) -> Filtered:
    """Return the fit of a deadband or of stiction near known sizes."""
    f = start.explanation.filtering
    few = Bank.of(f.scans, len(f.Y), FEW)
    return _followed(banked(start.explanation, start.values, few), few, 0.08, 0.03)


def left(one: Explanation, values: Mapping[str, float]) -> Filtered:
    """Return what a full bank with these sizes leaves."""
    f = one.filtering
    return banked(one, values, Bank.of(f.scans, len(f.Y), MANY))


def _followed(start: Filtered, bank: Bank, wide: float, finest: float) -> Filtered:
    """Return the fit near a start: one coordinate after the other, in steps from ``wide`` to ``finest``.

    After each round the same way once more (Hooke and Jeeves 1961): sizes and time constants make up for each other.
    """
    one, f = start.explanation, start.explanation.filtering
    best = banked(one, start.values, bank)
    steps = dict.fromkeys(one.own, wide) | {key: UNSURE * _tolerance(one, key) for key in f.unsure}
    ways = dict.fromkeys(steps, 1.0)
    for _ in range(ROUNDS):
        base = best
        for name in steps:
            for way in (ways[name], -ways[name]):
                new = banked(one, moved_stem(one, best.values, name, way * steps[name]), bank)
                if new.nll < best.nll - LEAST:
                    best, ways[name] = new, way
                    break
            else:
                steps[name] *= SHRINKS
        if best is base:
            if steps[one.own[0]] < finest:
                break
            continue
        new = banked(one, _again(one, base.values, best.values), bank)
        if new.nll < best.nll - LEAST:
            best = new
    return best


def _tolerance(one: Explanation, key: str) -> float:
    """Return how far a parameter may be from its nominal value, as a share of it, all of it at most."""
    low, high = one.bounds[key]
    return min(1.0, 0.5 * (high - low) / max(abs(one.nominal[key]), 1e-300))


def _again(one: Explanation, before: Mapping[str, float], now: Mapping[str, float]) -> dict[str, float]:
    """Return values as far beyond ``now`` as that is from ``before``, within bounds."""
    new = {**now, **{name: float(np.clip(2.0 * now[name] - before[name], *one.bounds[name])) for name in one.bounds}}
    if "J" in new:
        new["J"] = min(new["J"], new["S"])
    return new


def moved_stem(one: Explanation, values: Mapping[str, float], name: str, by: float) -> dict[str, float]:
    """Return values with one moved by a factor exp(by); of stiction S + J, where it gives way, or by a share of S
    S - J, where it stops: these two have little to do with each other.
    """
    new = dict(values)
    low, high = one.bounds[name]
    if "J" in one.own and name in one.own:
        way, stop = values["S"] + values["J"], values["S"] - values["J"]
        if name == "S":
            way *= np.exp(by)
        else:
            stop -= 2.0 * by * values["S"]
        stop = float(np.clip(stop, 0.0, way))
        new["S"] = float(np.clip(0.5 * (way + stop), *one.bounds["S"]))
        new["J"] = min(0.5 * (way - stop), new["S"])
        return new
    new[name] = float(np.clip(values[name] * np.exp(by), low, high))
    return new
