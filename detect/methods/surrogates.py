"""Surrogate predictability, Thornhill 2005: is the wave more predictable than linear waves of the same spectrum?

    rows of E samples; for each the K nearest rows at least E samples away; forecast = mean of what follows them by H
    Gamma = mean squared error of the forecast of PV
    N = (mean Gamma_twins - Gamma) / (3 std Gamma_twins),     non-linear if N > 1

E and H are one period, K = 8; the twins keep the spectrum and draw the phases anew (``signals.surrogates``). Before,
the wave is cut at upward crossings of zero, so that it repeats without a jump, and resampled to 12 a period: unmatched,
a clean sine scores 2 to 5.

N says that the wave is not linear, and no more: a valve, a saw-like outside wave or another non-linearity. It lives on
how cycles vary, because a wave that repeats exactly is as predictable as its twins. It never accuses or clears a valve;
among the tags that share one oscillation the largest N is nearest to its source, and that is what it is for.

Source: Thornhill 2005, IEEE Trans. Control Syst. Technol. 13:434; E, H, K and the number of twins after secondary
sources. Ours: ``FLOOR_SHARE`` for the spread of the twins, and the refusal of quantised and compressed PV.

Measured: none of 60 noisy sines, 10 narrow-band noises and 10 linear loops under an outside sine had N > 1; 7 of 10
loops that cycle by a sticky valve under a wandering load had, and none of 10 that repeat almost exactly. About 0.1 s.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.crossings import crossings
from stickslip.detect.signals.surrogates import phase_randomised
from stickslip.detect.verdict import FigureBase, Verdict
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

FLOOR_SHARE = 0.01  # of the variance of PV: twins of an almost clean line agree to less, and any leak would be many std

CARD = Card(
    name="surrogates", title="Surrogate predictability",
    source="Thornhill 2005, IEEE Trans. Control Syst. Technol. 13:434",
    signals=("PV",), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation", "stationary mean", "raw samples"),
    finds="whether the wave is non-linear; ranks the tags of one oscillation, the largest N nearest to its source",
    index=(0.0, math.inf), streams="window", cost="O(M n^2 E)", experimental=True, accuses=False,
    stream_note="Surrogates are made of the spectrum of one record, and the window must hold twelve cycles.",
    pros=("any tag, not only loops", "any kind of non-linearity", "no model"),
    cons=("does not say what is non-linear", "exact repetition looks linear", "sensitive to the ends of the record"),
    needs=("oscillation", "constant_sp", "unsaturated", "raw_pv", "fine_pv"),
    cycles=12.0, samples=(7.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings of the paper, but for ``per_period`` and ``samples``, which bound the cost.

    limit : N above which the wave is non-linear [-]
    per_period, samples : most samples of a period (7 to 25 in the paper), and of the record
    """

    limit: float = 1.0
    neighbours: int = 8
    twins: int = 20
    per_period: int = 12
    samples: int = 360


def forecast_error(x: Values, length: int, horizon: int, neighbours: int = 8) -> Values:
    """Mean squared error of the forecasts of signals x (m, n), each by its own past and future, shape (m,).

    A ramp cannot be predicted by its neighbours, a wave that repeats can:

    >>> t = np.arange(200.0)
    >>> wave, noise = np.sin(2 * np.pi * t / 10), np.random.default_rng(0).normal(size=200)
    >>> wrong = forecast_error(np.stack([wave, noise]), 10, 10)
    >>> bool(wrong[0] < 1e-12), bool(0.8 < wrong[1] < 1.6)
    (True, True)
    """
    n = x.shape[1]
    count = n - length - horizon + 1
    if count <= 2 * length + neighbours:
        raise ValueError(f"n = {n} with rows of {length} and a horizon of {horizon}; give a longer signal")
    close = np.abs(np.subtract.outer(np.arange(count), np.arange(count))) < length
    errors = np.empty(len(x))
    for i, signal in enumerate(x):
        rows = np.lib.stride_tricks.sliding_window_view(signal, length)[:count]
        square = np.einsum("ij,ij->i", rows, rows)
        away = (square[None, :] - 2.0 * rows @ rows.T).astype(np.float32)  # less what a row has in common
        away[close] = np.inf
        near = np.argpartition(away, neighbours, axis=1)[:, :neighbours]
        future = signal[length + horizon - 1 :]
        errors[i] = np.mean((future - future[near].mean(axis=1)) ** 2)
    return errors


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop, never more than "inconclusive"; the twins are the same at every call.

    >>> t = np.arange(2000.0)
    >>> sine = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t)
    >>> detect(sine).index < 1
    True
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.limit):
        return refusal
    period = min(round(loop.samples_per_period), p.per_period)
    x = _whole_cycles(loop, period, p.samples // period)
    if len(x) < CARD.cycles * period:
        few = f"{len(x) / period:.0f} whole cycles lie between crossings of zero; {CARD.cycles:g} are needed."
        return Verdict.not_applicable(CARD.name, "too_few_cycles", few, p.limit)
    twins = phase_randomised(x, p.twins, np.random.default_rng(0))
    gamma, *others = forecast_error(np.vstack([x, twins]), period, period, p.neighbours).tolist()
    signed = (float(np.mean(others)) - gamma) / (3.0 * max(float(np.std(others, ddof=1)), FLOOR_SHARE))
    index = max(signed, 0.0)
    if index > p.limit:
        why = "the wave is not linear; that may be the valve or anything else that is not linear"
    else:
        why = "no less predictable linear waves with its spectrum; a wave that repeats exactly looks so too"
    reason = (
        f"N = {index:.2f} (limit {p.limit:g}), forecast error {gamma:.3f} against {np.mean(others):.3f} of "
        f"{p.twins} linear twins over {len(x) / period:.0f} cycles: {why}. It ranks tags and judges no valve."
    )
    evidence: dict[str, Values | float] = {"gamma": gamma, "twins": np.array(others), "x": x, "twin": twins[0]}
    return Verdict(CARD.name, "inconclusive", index, p.limit, reason, evidence=evidence, draw=draw)


def _whole_cycles(loop: Prepared, period: int, most: int) -> Values:
    """Up to so many cycles of PV at ``period`` samples each on average, z-scored, from one upward crossing to another.

    The crossings are those of the smoothed wave, so that noise does not move the ends; between them the noise stays on,
    averaged over a sample of the new grid: without it the twins of a clean wave differ by rounding alone.
    """
    t, y, noisy = loop.stretch.t, loop.wave("PV"), loop.wave("PV", 0.0)
    zeros = crossings(t, y, 0.1 * float(np.std(y)))[::2]
    if len(zeros) < 2:
        return np.empty(0)
    start, end = float(zeros[0]), float(zeros[min(len(zeros) - 1, most)])
    n = 2 * round(0.5 * period * (end - start) / loop.period)
    each = max(1, round(loop.samples_per_period / period))
    means = np.convolve(noisy, np.full(each, 1.0 / each), "same")
    x = np.interp(start + (end - start) * np.arange(n) / max(n, 1), t, means)
    return np.asarray((x - np.mean(x)) / np.std(x)) if n else x


def draw(v: Verdict, figure: FigureBase) -> None:
    """The wave and one of its twins; the forecast errors of all twins, and of the record."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    left.plot(v.array("x")[:200], color=INK, lw=1.0, label="PV, drift off, z-scored")
    left.plot(v.array("twin")[:200] - 5.0, color=SOFT, lw=1.0, label="a linear twin (5 lower)")
    left.legend(frameon=False, fontsize=8.5, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    right.hist(v.array("twins"), bins=12, color=SOFT, alpha=0.6)
    right.axvline(float(v.array("gamma")[0]), color=INK)
    finish(left, "sample")
    finish(right, "forecast error: linear twins, and the record (line)", "twins")
