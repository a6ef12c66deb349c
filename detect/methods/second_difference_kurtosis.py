"""Kurtosis of the second difference, Yamashita 2006 for levels: a sticky valve bends a level at its slips only.

    d(k) = y(k+1) - 2 y(k) + y(k-1)        of the smoothed PV
    K = mean (d - mean d)^4 / (mean (d - mean d)^2)^2 - 3

Behind a sticky valve a level rises and falls along straight lines, and all of its bending sits in the corners: d is a
train of spikes and K high.  A sine bends all the time: K = -1.5; so does noise by chance: K = 0.

Source: Yamashita 2006, ESCAPE 16 (from memory: K above 0 is stiction, below -0.5 none).  Ours: the filter, which cuts
at five times the frequency and leaves a triangle at K = 2.1; the interval, by leaving out a tenth of the record at a
time; stiction only where all of it lies above 0; no verdict where more than half of d is noise; and a low K clears
nothing: a stem that slides on after it slipped rounds the corners off.

A level whose outlet steps for other reasons (on-off pumps, batches) bends in corners, too.  Not for self-regulating
processes, where a slip rounds off.  Cost: about 2 ms for 7,200 samples.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import CUT, Prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.normal import Z90

CARD = Card(
    name="second_difference_kurtosis", title="Kurtosis of the second difference", source="Yamashita 2006, ESCAPE 16",
    signals=("PV",), process=("integrating",),
    assumes=("integrating process", "sustained oscillation", "constant set point", "low noise"),
    finds="stiction in levels, from corners in PV; no amount",
    index=(-2.0, math.inf), streams="pooled", stream_bound=0.1, experimental=True,
    pros=("made for levels", "PV alone", "no phase needed"),
    cons=("any other stepping flow bends the level in corners", "noise", "needs smoothing"),
    needs=("oscillation", "constant_sp", "unsaturated", "fine_pv", "raw_pv", "known_process"),
    cycles=4.0, samples=(15.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """kurtosis : limit of the paper [-]; noise : largest share of noise in d [-], ours; parts left out in turn."""

    kurtosis: float = 0.0
    noise: float = 0.5
    parts: int = 10


def excess(d: Values) -> float:
    """K of the values (n,), 0 for a normal distribution.

    >>> round(excess(np.sin(2 * np.pi * np.arange(1000) / 1000)), 6)
    -1.5
    """
    d = d - np.mean(d)
    square = float(np.mean(d**2))
    return float(np.mean(d**4)) / square**2 - 3.0 if square > 0.0 else 0.0


def noise_share(d: Values, sigma: float, samples_per_period: float) -> float:
    """Variance of white noise of standard deviation sigma in d over that of d [-].

    The filter passes it with 1 / (1 + s^4), s = f / f_c, and the difference with (2 pi f)^2, so that its variance is
    2 (2 pi)^4 f_c^5 sigma^2 times the integral of s^4 / (1 + s^4)^2, which is pi sqrt(2) / 16; about a tenth less where
    a period has only 100 samples.
    """
    f_c = CUT / samples_per_period
    passed = 2.0 * (2.0 * math.pi) ** 4 * f_c**5 * math.pi * math.sqrt(2.0) / 16.0
    return passed * sigma**2 / max(float(np.var(d)), 1e-300)


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop."""
    return of_record(p, record, _seen, _judged)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """Number of values of d, means of d, d^2, d^3 and d^4 and the share of noise, in ``parts`` of the stretch."""
    if refusal := refused(CARD, loop, p.kurtosis):
        return refusal
    y, t = loop.wave("PV"), loop.stretch.t
    d = np.diff(y, 2)
    share = noise_share(d, loop.noise("PV"), loop.samples_per_period)
    parts = np.array_split(np.arange(len(d)), p.parts)
    sums = [[len(k), *((d[k] ** power).mean() for power in (1, 2, 3, 4)), share] for k in parts if len(k)]
    at = np.array([0.5 * (t[k[0]] + t[k[-1] + 2]) for k in parts if len(k)])
    return Pool(at, np.array(sums), float(t[0]), float(t[-1] - t[0]) / p.parts)


def _of_sums(rows: Values) -> float:
    """K of values whose number and mean powers (m, 5) are known in parts; 0 where all are equal."""
    m1, m2, m3, m4 = np.average(rows[:, 1:5], axis=0, weights=rows[:, 0])
    square = m2 - m1**2
    fourth = m4 - 4.0 * m1 * m3 + 6.0 * m1**2 * m2 - 3.0 * m1**4
    return float(fourth / square**2 - 3.0) if square > 0.0 else 0.0


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    K, m = _of_sums(pool.rows), len(pool.rows)
    left_out = np.array([_of_sums(np.delete(pool.rows, k, axis=0)) for k in range(m)])
    half = Z90 * math.sqrt((m - 1) / m * float(np.sum((left_out - np.mean(left_out)) ** 2)))
    share = float(np.average(pool.rows[:, 5], weights=pool.rows[:, 0]))
    word, why = _word(K, half, share, p)
    reason = f"K = {K:.2f}, 90 % interval {K - half:.2f} to {K + half:.2f}, {min(share, 1.0):.0%} noise: {why}."
    y = loop.wave("PV")
    evidence: dict[str, Values | float] = {"t": loop.stretch.t, "y": y, "d": np.diff(y, 2), "noise": share}
    return Verdict(CARD.name, word, K, p.kurtosis, reason, interval=(K - half, K + half), evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged, most=100)


def _word(K: float, half: float, share: float, p: Params) -> tuple[Word, str]:
    if share > p.noise:
        return "inconclusive", f"more than {p.noise:.0%} of the bending is noise"
    if K - half > p.kurtosis:
        return "stiction", "the level bends in corners, as the slips of a valve make it"
    if K < -0.5:
        return "inconclusive", "the level bends all the time, as a sine does; a valve that slips little does too, so "\
                               "nothing is cleared"  # fmt: skip
    return "inconclusive", "between a sine (-1.5) and corners (above 0)"


def draw(v: Verdict, figure: FigureBase) -> None:
    """PV and its second difference over time, and the distribution of the latter."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    grid = figure.add_gridspec(2, 2, width_ratios=(3, 1))
    top, low, right = (figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[:, 1]))
    t, d = v.array("t"), v.array("d") / np.std(v.array("d"))
    shown = slice(0, 2000)
    top.plot(t[shown], v.array("y")[shown], color=INK)
    low.plot(t[1:-1][shown], d[shown], color=INK)
    right.hist(d, 60, density=True, color=SOFT)
    x = np.linspace(-4.0, 4.0, 200)
    right.plot(x, np.exp(-0.5 * x**2) / math.sqrt(2.0 * math.pi), color=INK, ls=":")
    finish(top, "", "PV, smoothed")
    finish(low, "time [s]", "second difference [std]")
    finish(right, "second difference [std]", "", "dotted: normal")
