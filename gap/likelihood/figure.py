"""The bands of a stem whose position is logged, read off its MV-OP figure: row by row, from where the log has it.

A stem without mass, of which row k shows x_k where w_k is wanted, stands at the next row at

    x_k                              |w_k - x_k| <= f_s, and at rest: it sticks
    w_k - sgn(w_k - x_k) f_c         beyond: it has slipped
    w_k - d f_c                      it moved in direction d to row k, and what is wanted goes on in d

    sum_k ln(1 + (x_(k+1) - predicted)^2 / scale^2)   is least at its f_s = (S + J)/2 and f_c = (S - J)/2

over a grid that closes in.  No row depends on what a prediction before it has missed, as a replay does, so the trough
is wide; a stem with mass slips a moment after the row that pulls it off, and is read as well (S and J within 10 %).
"""

from collections.abc import Sequence

import numpy as np
from stickslip.gap.insertion.bent_valve import gives_flow
from stickslip.gap.insertion.paths import given
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.offsets import offsets
from stickslip.logs.arrays import Values

USUAL = 0.99  # quantile of how far a stem lies off: beyond are jumps of the set point
LEAST, MOST, SIZES = 0.05, 1.5, 24  # force of breakaway in shares of that, and how many are tried
SHARES = 11  # of the force while it slides, from none to all of it
ZOOMS, CLOSER = 5, 7  # grids, and points of those that close in
SCALE, FINEST = 0.05, 0.003  # of a miss that counts, in the first grid and the last
MOVED = 1e-6  # of its travel: so far a stem has moved that is not at rest


def read_off(one: Hypothesis) -> list[tuple[float, float]]:
    """Return first sizes of a stem and the second as a share of it, as the log of its position shows them.

    With a jump and without: what creeps has none, and may look like any.  None where that is not logged, or has never
    lain off what is wanted.
    """
    f, effect = one.frame, one.effect
    signal = given(f.model, one.place)
    if effect is None or signal not in f.record.pinned or gives_flow(f.model, one.place):
        return []
    seen = f.record.log[signal]
    wanted = seen - offsets(f.quiet, f.record)[0, :, f.record.pinned.index(signal)]
    free: list[float] = np.linspace(0.0, 1.0, SHARES).tolist()
    ways = [[1.0]] if len(one.own) < 2 else [free, [1.0]]
    to_unit = next(iter(effect.settings(f.model, one.place, **dict.fromkeys(one.own, 1.0)).values()))
    low, high = one.bounds[one.own[0]]
    found = [bands(wanted, seen, shares) for shares in ways]
    return [(float(np.clip(S / to_unit, low, high)), J / S) for S, J in (each for each in found if each is not None)]


def bands(wanted: Values, seen: Values, shares: Sequence[float]) -> tuple[float, float] | None:
    """Return S and J of a stem [its unit] from where it was ``wanted`` and ``seen``, (rows,); NaN says nothing.

    ``shares``: f_c / f_s, in order; 1 alone for a deadband.  None for a stem that is where it is wanted.

    >>> from stickslip.blocks import QuasiStaticStem
    >>> from stickslip.diagram import drive
    >>> t = np.arange(600.0)
    >>> OP = 0.5 + 0.1 * np.sin(t / 40.0) + 0.003 * np.random.default_rng(1).standard_normal(600)
    >>> MV = drive(QuasiStaticStem(S=0.07, J=0.03), 599.0, every=1.0, OP=(t, OP)).log["MV"]
    >>> S, J = bands(OP[1:], MV[1:], np.linspace(0.0, 1.0, 11).tolist())
    >>> round(S, 2), round(J, 2)
    (0.07, 0.03)
    """
    off = np.abs(wanted - seen)
    usual = float(np.nanquantile(off, USUAL)) if np.isfinite(off).any() else 0.0
    if not usual > 0.0:
        return None
    found = [_closed_in(_rows(wanted, seen, late), usual, shares) for late in (False, True)]
    _, f_s, share = min(found)
    return (1.0 + share) * f_s, (1.0 - share) * f_s


def _rows(wanted: Values, seen: Values, late: bool) -> tuple[Values, ...]:
    """Return (w, x, x after, d) of the rows that are known, d 0 for a stem that sticks.

    ``late``: a row shows the stem as it has answered to what is wanted there, not as it was found.
    """
    w, before = (wanted[2:], wanted[1:-1]) if late else (wanted[1:-1], wanted[:-2])
    x, after = seen[1:-1], seen[2:]
    moved = x - seen[:-2]
    way = np.where(np.abs(moved) > MOVED * float(np.nanmax(seen) - np.nanmin(seen)), np.sign(moved), 0.0)
    way = np.where((w - before) * way >= 0.0, way, 0.0)
    known = np.isfinite(w) & np.isfinite(before) & np.isfinite(after) & np.isfinite(moved)
    return w[known], x[known], after[known], way[known]


def _closed_in(rows: tuple[Values, ...], usual: float, shares: Sequence[float]) -> tuple[float, float, float]:
    """Return the least loss, f_s and f_c / f_s."""
    w, x, after, way = rows
    far, side = np.abs(w - x), np.sign(w - x)
    sizes, q = np.geomspace(LEAST * usual, MOST * usual, SIZES), np.asarray(shares, dtype=float)
    scale, best = SCALE, (np.inf, 0.0, 0.0)
    for _ in range(ZOOMS):
        best = (np.inf, 0.0, 0.0)
        for f_s in sizes.tolist():
            for share in q.tolist():
                f_c = share * f_s
                foretold = np.where(way != 0.0, w - way * f_c, np.where(far > f_s, w - side * f_c, x))
                loss = float(np.log1p(((foretold - after) / (scale * usual)) ** 2).sum())
                best = min(best, (loss, f_s, share))
        _, f_s, share = best
        near = np.log(sizes[-1] / sizes[0]) / (len(sizes) - 1)
        sizes = f_s * np.exp(np.linspace(-near, near, CLOSER))
        if len(q) > 1:
            apart = (q[-1] - q[0]) / (len(q) - 1)
            q = np.unique(np.clip(np.linspace(share - apart, share + apart, CLOSER), 0.0, 1.0))
        scale = max(0.5 * scale, FINEST)
    return best
