"""Change and no change, Kano et al. 2004 method A: the stem stands still while OP travels.

    stuck    longest intervals with |y(t) - y(t - k)| < eps;    u~, y~ = range of OP and y over one
    counts   u~ >= eps_u and y~ <= eps_y
    rho = samples in intervals that count / all samples;    amount = mean of u~ over them

y is MV where it is logged, else PV, which stands for the stem in a flow loop of short dead time.

Source: Kano, Maruta, Kugemoto, Shimizu 2004, DYCOPS, whose three limits belong to each loop.  Ours: k is a thirtieth of
the period, y is averaged over k, eps is three sigma of the noise in that difference but at least 1 % of the range of y,
eps_u a quarter of OP's travel between two turns, eps_y twice eps but at most 15 % of the range of y; stiction where
rho >= 0.3, in four intervals or more and with as many turns of OP, because a load ramp looks the same.  A small rho
clears nothing: noise breaks the intervals up as well as a healthy valve does.  Averaging takes
some 10 % of S off the travel where y is the stem; a lag of PV eats the beginning of each stand, and half may be lost.

Not for slow processes without MV, long dead time, or PV on a coarse grid.  Cost: about 5 ms for 7,200 samples.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused, too_short
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.prepare.stem_signal import stem_signal
from stickslip.detect.signals.runs import runs
from stickslip.detect.signals.smoothing import noise_std
from stickslip.detect.stem.play import travel_of
from stickslip.detect.stem.stick import turn_time
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Indices, Values
from stickslip.logs.normal import Z90

CARD = Card(
    name="change_no_change", title="Change and no change",
    source="Kano, Maruta, Kugemoto, Shimizu 2004, DYCOPS, method A",
    signals=("OP", "MV", "PV"), process=("self_regulating",),
    assumes=("MV logged, or a fast flow loop", "short dead time"),
    finds="stiction, from the time that the stem stands while OP travels; the travel in % of OP",
    index=(0.0, 1.0), streams="pooled", stream_bound=0.1, experimental=True,
    pros=("simple", "no oscillation needed", "gives the travel"),
    cons=("limits belong to each loop", "the travel is less than S", "noise hides it", "slow processes without MV"),
    needs=("unsaturated", "fine_pv", "raw_pv"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """rho_stiction : as in ``methods.md`` of the notes; the other limits are ours, see the module.

    noise : eps over the noise of the difference [-]     floor, cap : least eps and most eps_y [share of y's range]
    travel : eps_u [share of OP's travel]                 intervals, samples : fewest of each, of the turns of OP, too
    """

    rho_stiction: float = 0.3
    noise: float = 3.0
    floor: float = 0.01
    cap: float = 0.15
    travel: float = 0.25
    intervals: int = 4
    samples: int = 150


class Stuck(NamedTuple):
    """rho [-], first and last sample of the intervals that count (r,), OP travel over each (r,), eps [unit of y]."""

    rho: float
    first: Indices
    last: Indices
    travel: Values
    eps: float


def stuck(u: Values, y: Values, k: int, sigma: float, reach: float, p: Params = Params()) -> Stuck:
    """Where y (n,) stands and u (n,) travels; differences over k samples; sigma: noise of y, ``reach``: travel of u.

    A stem that jumps once in 40 samples, while OP moves by 1 a sample and turns 9 after each jump:

    >>> u = 50.0 - np.abs(np.arange(401.0) % 80 - 40)
    >>> y = np.sign(np.sin(np.arange(401.0) * np.pi / 40 - 0.7))
    >>> found = stuck(u, y, 1, 0.0, 40.0)
    >>> round(found.rho, 1), round(float(np.median(found.travel)))
    (1.0, 31)
    """
    smooth = np.convolve(np.pad(y, (k // 2, k - 1 - k // 2), mode="edge"), np.ones(k) / k, mode="valid")
    swing = float(np.percentile(smooth, 99) - np.percentile(smooth, 1))
    eps = max(p.noise * sigma * np.sqrt(2.0 / k), p.floor * swing)
    quiet = np.concatenate([np.zeros(k, dtype=bool), np.abs(smooth[k:] - smooth[:-k]) < eps])
    first, end = runs(quiet)
    last = end - 1
    keep, travel = [], []
    for i, (a, b) in enumerate(zip(first.tolist(), last.tolist(), strict=True)):
        a = max(a - k, 0)
        moved = float(np.ptp(u[a : b + 1]))
        if moved >= p.travel * reach and np.ptp(smooth[a : b + 1]) <= min(2.0 * eps, p.cap * swing):
            keep.append(i)
            travel.append(moved)
    first, last = first[keep], last[keep]
    rho = min(float(np.sum(last - first + k)) / len(y), 1.0)
    return Stuck(rho, first, last, np.array(travel), float(eps))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    return of_record(p, record, _seen, _judged)


def _look(p: Params, loop: Prepared) -> tuple[Stuck, int, Indices]:
    """The intervals of a window, the k of its differences, and the samples at which OP turns."""
    grid = loop.whole
    at, turn = turn_time(grid.op, loop.period / grid.dt)
    y, k = stem_signal(grid)[1], max(1, round(turn / 15.0))
    return stuck(grid.op, y, k, noise_std(grid.t, y), travel_of(grid.op, turn), p), k, np.asarray(at, dtype=np.intp)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """The intervals (samples and travel of OP over each) and the turns of OP (no samples, no travel)."""
    if refusal := refused(CARD, loop, p.rho_stiction) or too_short(CARD, loop.whole, p.samples, p.rho_stiction):
        return refusal
    grid = loop.whole
    found, k, turns = _look(p, loop)
    at = np.concatenate([0.5 * (grid.t[found.first] + grid.t[found.last]), grid.t[turns]])
    rows = np.zeros((len(at), 2))
    rows[: len(found.travel)] = np.column_stack([found.last - found.first + k, found.travel])
    order = np.argsort(at, kind="stable")
    return Pool(at[order], rows[order], float(grid.t[0]))


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    grid = loop.whole
    name, y = stem_signal(grid)
    found, _, _ = _look(p, loop)
    stood = pool.rows[:, 0] > 0.0
    travel, turns = pool.rows[stood, 1], int((~stood).sum())
    samples = (grid.t[-1] - pool.since) / grid.dt + 1.0
    rho = min(float(pool.rows[:, 0].sum()) / samples, 1.0)
    m = len(travel)
    enough = min(m, turns) >= p.intervals
    word: Word = "stiction" if rho >= p.rho_stiction and enough else "inconclusive"
    amount = loop.op_percent(float(np.mean(travel))) if word == "stiction" else None
    size = "" if amount is None else f", on average by {amount:.3g} % of OP"
    why = (
        f"{name} stands while OP travels{size}" if word == "stiction"
        else f"fewer than {p.intervals} intervals or turns of OP ({turns})" if rho >= p.rho_stiction
        else "which clears nothing, because noise and lag break the intervals up too"
    )  # fmt: skip
    reason = f"rho = {rho:.2f} of the time in {m} intervals ({p.rho_stiction:g} for stiction): {why}."
    evidence: dict[str, Values | float] = {
        "t": grid.t, "u": grid.op, "y": y, "first": grid.t[found.first], "last": grid.t[found.last], "travel": travel,
        "eps": found.eps, "mv": float(name == "MV"),
    }  # fmt: skip
    if m > 1:
        half = Z90 * float(np.std(travel, ddof=1)) / np.sqrt(m)
        mean = float(np.mean(travel))
        for key, value in (("S_low", mean - half), ("S_high", mean + half)):
            evidence[key] = loop.op_percent(value) or value
    return Verdict(CARD.name, word, rho, p.rho_stiction, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged, most=800)


def draw(v: Verdict, figure: FigureBase) -> None:
    """OP and the stem (or PV) over time, with the intervals that count shaded."""
    from stickslip.detect.figures.verdict import draw_stands

    signals = {"OP": v.array("u")[:800], "MV" if v.array("mv")[0] else "PV": v.array("y")[:800]}
    stands = np.column_stack([v.array("first"), v.array("last")]).tolist()
    draw_stands(figure.subplots(2, 1, sharex=True), v.array("t")[:800], signals, stands)
