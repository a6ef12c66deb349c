"""Fit stiction or a deadband with a bank of stems: a grid over the sizes, then patterns around the best, ever smaller.

The model's unsure parameters and the switches of its inputs start as the model without friction has them, and move with
the sizes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gap.effect import Effect
from gap.effects.deadband import Deadband
from gap.effects.stiction import Stiction
from gap.filters import kalman, stems
from gap.filters.filtering import Explanation, Filtered
from gap.filters.fitting import Found
from gap.inserted import percent_in

Floats = NDArray[np.float64]
FEW, MANY = 20, 48  # stems of the grid and of the fit
SHARES = (0.15, 0.35, 0.6)  # of J in S that are tried
WIDER = (1.0, 1.12, 1.3)  # of S over the width of the deadband that comes nearest
SIZES = 9  # widths that are tried
SMALLEST, LARGEST = 0.25, 15.0  # [%], of S
FINEST = 0.008  # relative size of the last pattern
ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Bank:
    """The random numbers of a bank: the same for all sizes."""

    draws: Floats
    turns: Floats

    @classmethod
    def of(cls, scans: int, rows: int, count: int, seed: int = 0) -> "Bank":
        """Return numbers for so many scans, rows and stems."""
        rng = np.random.default_rng([seed, count])
        return cls(rng.normal(size=(scans, count)), rng.random(rows))


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
    A, K, s = np.empty((n, n)), np.zeros((kinds, n)), np.ones(kinds)
    kalman.closed(m.F, m.free, m.told, n, 0.0, False, A)
    stems.settled_gains(A, m.Q, m.shown, f.r, f.every, K, s)
    moves = int(np.argmax(np.abs(m.told[n : n + len(m.v)])))
    jitter = stems.unsure(m.Q, m.free[moves][:n])
    e, loss, path = np.empty(f.Y.shape), np.empty(len(f.Y)), np.empty(len(f.Y))
    stems.banked(
        m.F, m.v, m.told, m.H, m.limits, m.memory, m.of, m.beyond, m.last, m.start, U, f.Y, f.acts, moves, f.every, K,
        s, jitter, S, J, bank.draws, bank.turns, e, loss, path,
    )  # fmt: skip
    e = stems.deviates(e)
    return Filtered(one, full, e, np.where(np.isnan(e), np.nan, 1.0), path, loss)


def fitted_stems(plain: Found, effects: Sequence[tuple[Effect, str]]) -> list[Found]:
    """Return the best sizes of a deadband and of stiction where a catalogue has them, the likeliest first.

    The width of a deadband says near which S stiction has to be looked for: its jump makes S somewhat larger.
    """
    f = plain.best.explanation.filtering
    few, many = (Bank.of(f.scans, len(f.Y), count) for count in (FEW, MANY))
    free = {key: plain.best.values[key] for key in f.free}
    found = []
    for place in dict.fromkeys(place for _, place in effects):
        flat = Explanation(f, Deadband(), place)
        widths = np.geomspace(SMALLEST, LARGEST, SIZES).tolist()
        start = min((banked(flat, {**free, "width": w}, few) for w in widths), key=lambda x: x.nll)
        play = _followed(_followed(start, few, 0.25, 0.06), many, 0.06, FINEST)
        here = [effect for effect, at in effects if at == place]
        if any(isinstance(effect, Deadband) for effect in here):
            found.append(Found(play, (), np.zeros((0, 0))))
        stiction = next((effect for effect in here if isinstance(effect, Stiction)), None)
        if stiction is not None:
            one = Explanation(f, stiction, place)
            own = {key: play.values[key] for key in f.free}
            points = [
                {**own, "S": play.values["width"] * by, "J": play.values["width"] * by * share}
                for by in WIDER
                for share in SHARES
            ]
            start = min((banked(one, values, few) for values in points), key=lambda x: x.nll)
            stuck = _followed(_followed(start, few, 0.08, 0.04), many, 0.05, FINEST)
            found.append(Found(stuck, (), np.zeros((0, 0))))
    return sorted(found, key=lambda x: x.nll)


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
    """Return the fit near a start: one coordinate after the other, in steps from ``wide`` to ``finest``."""
    one, f = start.explanation, start.explanation.filtering
    best = banked(one, start.values, bank)
    steps = dict.fromkeys(one.own, wide) | {key: wide * f.quiet.tolerances[key] for key in f.free}
    for _ in range(ROUNDS):
        moved = False
        for name, step in list(steps.items()):
            for way in (1.0, -1.0):
                new = banked(one, _moved(one, best.values, name, way * step), bank)
                if new.nll < best.nll - 0.1:
                    best, moved = new, True
                    break
            else:
                steps[name] = 0.4 * step
        if not moved and steps[one.own[0]] < finest:
            break
    return best


def _moved(one: Explanation, values: Mapping[str, float], name: str, by: float) -> dict[str, float]:
    """Return values with one moved: a size or a parameter by a factor, J by a share of S."""
    new = dict(values)
    if name == "J":
        new["J"] = float(np.clip(values["J"] + by * values["S"], 0.0, values["S"]))
        return new
    low, high = one.bounds[name]
    new[name] = float(np.clip(values[name] * np.exp(by), low, high))
    if name == "S":
        new["J"] = values["J"] * new["S"] / values["S"]
    return new
