"""Qualitative movements, Yamashita 2006: how often OP moves while the stem stands, and then jumps after it.

    dU, dX    differences of OP and of the stem X, less their mean, over their standard deviation, some 28 a period
    symbols   I above ``level``, D below -``level``, else S; pairs (OP, X); pairs SS are left out, N samples remain
    rho_1 = (tau_IS + tau_DS) / N
    rho_2 = (tau_IS II + tau_IS SI + tau_DS DD + tau_DS SD) / N      runs of IS or DS by what follows them
    rho_3 = rho_1 less the runs of IS or DS that any other pattern follows

The sticky stem stands (S) while OP rises (I), then rises too (II) or alone (SI).  X is MV where it is logged, else PV,
which stands for the stem in a flow loop; it is turned over where the process gain is negative.  S is the median
travel of OP from its turn to the middle of the move of X that ends a run which rho_2 counts, J the travel of X in that
move, in the unit of X.  (Over the pairs alone S is a third low: smoothing makes a slip a ramp.)  S comes out 10 to 25 %
low, because smoothing rounds the turns of OP too.

Source: Yamashita 2006, Control Eng. Practice 14:503, stiction above 0.25, the share of two patterns of eight by chance.
From memory of the paper: the level of 1.  Ours: a level of 0.7, because the slope of an even triangle is 1 standard
deviation exactly; 0.20 to 0.30 is left open, and less clears nothing.

An outside sine that puts OP and PV a quarter of a period apart makes the same movements: rho_3 = 2 asin(0.7 / sqrt 2) /
pi = 0.33.  So, ours, rho_3 must exceed that of the record's linear twins by 0.05 (``stem.linear_twins``).

Measured on 311 simulated loops, tight or under an outside sine, square or stochastic wave: 2 called sticky, both under
a square (16 of 140 without the twins); of 160 sticky ones, many at rest, 22 found.  The margin was chosen after a part
of these had been seen, so this is partly a fit; ``docs/evidence/method_rates.md`` has seeds that served nothing else.

Not for levels, temperatures or gas pressures without MV.  Cost: about 3 ms for 7,200 samples.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.prepare.stem_signal import stem_signal
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.linear_twins import linear_twins
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Indices, Values
from stickslip.logs.normal import OF_MEDIAN, Z90

CARD = Card(
    name="qualitative_movements", title="Qualitative movements", source="Yamashita 2006, Control Eng. Practice 14:503",
    signals=("OP", "MV", "PV"), process=("self_regulating",),
    assumes=("MV logged, or a flow loop", "sustained oscillation of one period"),
    finds="stiction, from the order in which OP and the stem move; S in % of OP, J in the unit of the stem",
    index=(0.0, 1.0), streams="pooled", stream_bound=0.1, experimental=True,
    pros=("simple", "sees irregular cycles", "gives S and J"),
    cons=("finds about half of the sticky valves", "a sine a quarter of a period behind looks the same", "noise"),
    needs=("oscillation", "unsaturated", "fine_pv", "raw_pv"),
    cycles=5.0, samples=(12.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """rho : limit of the paper [-]; band : left open on either side of it [-], ours; level [standard deviations], ours.

    per_period : samples a period after thinning, 25 to 30 in the paper     runs : fewest sticking runs, ours
    beyond : rho_3 above that of the record's linear twins [-], ours
    """

    rho: float = 0.25
    band: float = 0.05
    level: float = 0.7
    per_period: float = 28.0
    runs: int = 6
    beyond: float = 0.05


class Movements(NamedTuple):
    """rho_1, rho_2, rho_3 [-]; over the runs that rho_2 counts: travel of u (r,) and of the move of x after it (r,)."""

    rho_1: float
    rho_2: float
    rho_3: float
    S: Values
    J: Values
    pairs: Indices


def movements(u: Values, x: Values, level: float = 0.7) -> Movements:
    """Count the movements of u and x (n,), which rise together where nothing sticks.

    A sine and one a quarter of a period behind it; the stem rests for asin(0.7 / sqrt 2) / 90 degrees of the time:

    >>> t = 2 * np.pi * np.arange(28_000) / 2800
    >>> found = movements(np.sin(t), np.sin(t - np.pi / 2))
    >>> round(found.rho_1, 2), round(found.rho_3, 2)
    (0.33, 0.33)
    """
    found, pairs, _ = _runs(u, x, level)
    return _counted(found, pairs)


def _runs(u: Values, x: Values, level: float) -> tuple[Values, Indices, Indices]:
    """The runs of equal movements (r, 6), the movements themselves, and the sample at which each run starts (r,).

    Of each run: its samples; whether the stem stands, and is followed rightly or wrongly (0 or 1); travels S and J.
    """
    du, dx = _symbols(np.diff(u), level), _symbols(np.diff(x), level)
    kept = np.flatnonzero((du != 0) | (dx != 0))
    if not len(kept):
        return np.empty((0, 6)), np.empty(0, dtype=int), np.empty(0, dtype=int)
    pair = 3 * du[kept] + dx[kept]
    starts = np.concatenate([[0], np.flatnonzero(np.diff(pair)) + 1])
    ends = np.concatenate([starts[1:], [len(pair)]])
    way, moves = du[kept][starts], dx[kept][starts]
    stands = (way != 0) & (moves == 0)
    after_u, after_x = np.append(way[1:], 0), np.append(moves[1:], 0)
    right = stands & (after_x == way) & (after_u != -way)
    wrong = stands & ~right
    wrong[-1] = False  # nothing follows the last run
    following = np.minimum(np.arange(len(starts)) + 1, len(starts) - 1)
    S, J = np.zeros((2, len(starts)))
    for r in np.flatnonzero(right).tolist():
        S[r], J[r] = _sizes(u, x, dx, int(kept[starts[following[r]]]), int(way[r]))
    rows = np.column_stack([ends - starts, stands, right, wrong, S, J])
    return rows, 3 * du + dx, kept[starts]


def _sizes(u: Values, x: Values, dx: Indices, at: int, way: int) -> tuple[float, float]:
    """S and J of the move of the stem that is under way at ``at``: from the turn of OP to where the stem is fastest.

    Smoothing makes a slip a ramp, so that the stem seems to stand for less than it does; in its middle it is fastest.
    """
    first, last = _move(dx, at)
    before = np.flatnonzero(dx[:first])
    since = 0
    if len(before):
        a, b = _move(dx, int(before[-1]))
        since = a + int(np.argmax(np.abs(np.diff(x[a : b + 1]))))
    slip = first + int(np.argmax(np.abs(np.diff(x[first : last + 1]))))
    reached = 0.5 * (u[slip] + u[slip + 1])
    return float(max(way * reached - np.min(way * u[since : slip + 1]), 0.0)), float(abs(x[last] - x[first]))


def _move(dx: Indices, at: int) -> tuple[int, int]:
    """The samples at which the move of the stem that is under way at ``at`` starts and ends."""
    other = np.flatnonzero(dx != dx[at])
    k = int(np.searchsorted(other, at))
    return int(other[k - 1]) + 1 if k else 0, int(other[k]) if k < len(other) else len(dx)


def _counted(runs: Values, pairs: Indices) -> Movements:
    """The numbers of the paper for runs (r, 6)."""
    if not len(runs):
        return Movements(0.0, 0.0, 0.0, np.empty(0), np.empty(0), pairs)
    length, stands, right, wrong, S, J = runs.T
    of_all = [float(length @ which) / float(length.sum()) for which in (stands, right, wrong)]
    good = right > 0.0
    return Movements(of_all[0], of_all[1], of_all[0] - of_all[2], S[good], J[good], pairs)


def _symbols(d: Values, level: float) -> Indices:
    std = float(np.std(d))
    z = (d - np.mean(d)) / std if std > 0.0 else np.zeros_like(d)
    return np.where(z > level, 1, np.where(z < -level, -1, 0))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    return of_record(p, record, _seen, _judged)


def _signals(p: Params, loop: Prepared) -> tuple[Values, Values, Values, float, str]:
    """Times, OP and the stem at ``per_period`` samples a period, (n,), the sign of the latter and its name."""
    grid = loop.stretch
    name = stem_signal(grid)[0]
    sign = 1.0 if name == "MV" else controller_sign(grid.op, grid.e)
    n = min(len(grid), math.ceil((grid.t[-1] - grid.t[0]) / loop.period * p.per_period) + 1)
    t = np.linspace(grid.t[0], grid.t[-1], n)
    return t, np.interp(t, grid.t, loop.wave("OP")), sign * np.interp(t, grid.t, loop.wave(name)), sign, name


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """The runs of equal movements."""
    if refusal := refused(CARD, loop, p.rho):
        return refusal
    t, u, x, _, _ = _signals(p, loop)
    runs, _, starts = _runs(u, x, p.level)
    return Pool(t[starts], runs, float(t[0]))


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    t, u, x, sign, name = _signals(p, loop)
    found = _counted(pool.rows, _runs(u, x, p.level)[1])
    twins = linear_twins(u, x, 0.5 * p.per_period, 1.0)
    chance = max(movements(u, twin, p.level).rho_3 for twin in twins)
    word, why = _word(found, chance, p)
    S = float(np.median(found.S)) if len(found.S) else math.nan
    amount = loop.op_percent(S) if word == "stiction" else None
    size = "" if amount is None else f", S = {amount:.3g} % of OP"
    reason = (
        f"rho_3 = {found.rho_3:.2f} (rho_1 {found.rho_1:.2f}, rho_2 {found.rho_2:.2f}, {len(found.S)} runs, {name} as "
        f"the stem): {why}{size}."
    )
    evidence: dict[str, Values | float] = {
        "t": t, "u": u, "x": sign * x, "pairs": found.pairs.astype(float), "rho_1": found.rho_1, "rho_2": found.rho_2,
        "rho_3": found.rho_3, "J": float(np.median(found.J)) if len(found.J) else math.nan, "mv": float(name == "MV"),
        "chance": chance,
    }  # fmt: skip
    if len(found.S) > 3:
        half = Z90 * OF_MEDIAN * float(np.std(found.S, ddof=1)) / math.sqrt(len(found.S))
        evidence["S_low"] = loop.op_percent(S - half) or S - half
        evidence["S_high"] = loop.op_percent(S + half) or S + half
    return Verdict(CARD.name, word, found.rho_3, p.rho, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged, most=1200)


def _word(found: Movements, chance: float, p: Params) -> tuple[Word, str]:
    if len(found.S) < p.runs:
        return "inconclusive", f"fewer than {p.runs} runs in which OP moves first and the stem after it"
    if found.rho_3 > p.rho + p.band and found.rho_3 < chance + p.beyond:
        return "inconclusive", f"a lag without sticking makes {chance:.2f}; {p.beyond:g} more is needed"
    if found.rho_3 > p.rho + p.band:
        return "stiction", "OP moves while the stem stands, and the stem follows in a move of its own"
    if found.rho_3 >= p.rho - p.band:
        return "inconclusive", f"too close to {p.rho:g}, which chance makes too"
    return "inconclusive", (
        "OP and the stem mostly move together or at odds; noise and lags do that too, which clears nothing"
    )


def draw(v: Verdict, figure: FigureBase) -> None:
    """OP and the stem over time with the sticking pairs (IS, DS) marked."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    top, low = figure.subplots(2, 1, sharex=True)
    t, stuck = v.array("t")[:300], np.abs(v.array("pairs")[:299]) == 3.0
    for axes, name, label in ((top, "u", "OP"), (low, "x", "MV" if v.array("mv")[0] else "PV")):
        y = v.array(name)[:300]
        axes.plot(t, y, color=SOFT)
        at = np.flatnonzero(stuck[: len(t) - 1])
        axes.plot([t[at], t[at + 1]], [y[at], y[at + 1]], color=INK, lw=2.5)
        finish(axes, "", label)
    top.set_title("heavy: OP moves, the stem stands (IS, DS)", fontsize=9, loc="left")
    low.set_xlabel("time [s]")
