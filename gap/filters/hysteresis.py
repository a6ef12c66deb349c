"""Fit stiction or a deadband with a bank of stems: a grid over the sizes, then patterns around the best, ever smaller.

The model's unsure parameters and the switches of its inputs start as the model without friction has them, and move with
the sizes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gap.effects.deadband import Deadband
from gap.filters import kalman, stems
from gap.filters.filtering import Explanation, Filtered
from gap.filters.fitting import Found
from gap.inserted import percent_in

Floats = NDArray[np.float64]
FEW, MANY = 24, 60  # stems of the grid and of the fit
SHARES = (0.0, 0.3, 0.65)  # of J in S that are tried
SIZES = 8  # of S that are tried
SMALLEST, LARGEST = 0.25, 15.0  # [%], of S
FINEST = 0.01  # relative size of the last pattern
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
    kalman.closed(m.F, m.v, m.told, n, True, 0.0, False, A)
    P = stems.settled_gains(A, m.Q, np.ascontiguousarray(m.H[:, :n]), f.r, f.every, K, s)
    jitter = np.empty(f.every)
    stems.unsure(A, m.Q, np.ascontiguousarray(m.v[:n]), P, f.every, jitter)
    e, loss = np.empty(f.Y.shape), np.empty(len(f.Y))
    op_row = f.signals.index(f.op) if f.op in f.signals else -1
    stems.banked(
        m.F, m.v, m.told, m.H, *m.limits, m.memory, m.beyond, m.start, U, f.Y, op_row, f.every, K, s, jitter, S, J,
        bank.draws, bank.turns, e, loss,
    )  # fmt: skip
    e = stems.deviates(e)
    return Filtered(one, full, e, np.ones_like(e), np.empty(0), loss)


def fitted_stem(plain: Found, one: Explanation, near: Filtered | None = None) -> Found:
    """Return the best sizes of stiction or of a deadband; ``near``: a fit of another one of them, to start from."""
    f = plain.best.explanation.filtering
    one = replace(one, filtering=f)
    few, many = (Bank.of(f.scans, len(f.Y), count) for count in (FEW, MANY))
    free = {key: plain.best.values[key] for key in f.free}
    flat = isinstance(one.effect, Deadband)
    if near is None:
        points = [
            {**free, **_sizes(flat, float(S), share)}
            for S in np.geomspace(SMALLEST, LARGEST, SIZES)
            for share in (SHARES[:1] if flat else SHARES)
        ]
    else:
        S = near.values["width"] if "width" in near.values else near.values["S"]
        free = {key: near.values[key] for key in f.free}
        points = [{**free, **_sizes(flat, S * by, 0.0 if flat else 0.1)} for by in (0.9, 1.0, 1.1)]
    start = min((banked(one, values, few) for values in points), key=lambda x: x.nll)
    best = banked(one, start.values, many)
    steps = dict.fromkeys(one.own, 0.2) | {key: 0.25 * f.quiet.tolerances[key] for key in f.free}
    steps |= {"J": 0.12} if not flat else {}
    for _ in range(ROUNDS):
        moved = False
        for name, step in list(steps.items()):
            for way in (1.0, -1.0):
                values = _moved(one, best.values, name, way * step)
                new = banked(one, values, many)
                if new.nll < best.nll - 0.1:
                    best, moved = new, True
                    break
            else:
                steps[name] = 0.45 * step
        if not moved and max(steps.values()) < FINEST:
            break
    return Found(best, (), np.zeros((0, 0)))


def _sizes(flat: bool, S: float, share: float) -> dict[str, float]:
    return {"width": S} if flat else {"S": S, "J": share * S}


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
