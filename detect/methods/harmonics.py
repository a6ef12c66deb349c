"""Third harmonics of OP and PV: a triangle has its third harmonic in phase with the first, a square against it.

    h3 = |a_3| / |a_1|,    c3 = cos(arg a_3 - 3 arg a_1)

a_k is the complex amplitude at k times the frequency, from blocks of four periods under a Hann window whose frequency
is refined within 20 %; the medians over the blocks count.  A triangle has h3 = 1/9 and c3 = +1, a square h3 = 1/3 and
c3 = -1, a sine h3 = 0; c3 does not depend on where the block starts.  A sticky valve in a self-regulating loop makes OP
triangular while PV is square; before an integrating process it makes PV triangular while OP, with parabolas in it, is
less so.

    index = min(c3(OP), -c3(PV)) in self-regulating loops, c3(PV) in integrating ones

Source: ours (design notes, section 3.6), after the harmonic methods of the literature; limits ours, not calibrated.
It accuses or abstains: it never clears a valve.  Not for waves with a strong second harmonic (above 0.3), whose halves
are unequal, and not for outside squares on a level, which make PV triangular too.

A stream keeps the amplitudes of the blocks; they need the period beforehand, so it comes from the last samples.
Measured on the prepared record: 3 ms for 7,200 samples.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

Complex = npt.NDArray[np.complex128]

CARD = Card(
    name="harmonics", title="Third harmonics",
    source="design notes of this project, after harmonic methods of the literature",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "PI controller", "half waves of nearly equal length"),
    finds="whether OP is triangular while PV is square (level: PV triangular); no amount",
    index=(-1.0, 1.0), streams="pooled", stream_bound=0.05, cost="O(n)", experimental=True,
    pros=("no crossings needed", "shrugs off noise and offsets", "hardly ever accuses by chance"),
    cons=("abstains often", "the kind of process must be known", "never clears a valve"),
    needs=("known_process", "oscillation", "constant_sp", "unsaturated"),
    cycles=8.0, samples=(12.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of c3, h3 and h2 [-], periods in a block, and how far its frequency is refined [-]; all ours."""

    c3: float = 0.7
    h3_triangle: float = 0.03
    h3_square: float = 0.10
    h3_level: float = 0.05
    h2_max: float = 0.3
    periods: float = 4.0
    refine: float = 0.2


class Harmonics(NamedTuple):
    """|a_2| / |a_1|, |a_3| / |a_1| and cos(arg a_3 - 3 arg a_1), medians over the blocks [-]."""

    h2: float
    h3: float
    c3: float


def amplitudes(waves: tuple[Values, ...], length: int, period: float, refine: float = 0.2) -> tuple[Complex, ...]:
    """Complex amplitudes (3, B) of each wave (n,) in B blocks of ``length`` samples that overlap by half.

    ``period`` [samples] is where the search for the frequency of each block starts; all waves share it.

    >>> t = 2 * np.pi * np.arange(1000) / 50.3
    >>> (a,) = amplitudes((np.sin(t) - np.sin(3 * t) / 9,), 200, 50.0)
    >>> found = harmonics_of(a)
    >>> round(found.h3, 3), round(found.c3, 3)
    (0.111, 1.0)
    """
    starts = np.arange(0, len(waves[0]) - length + 1, max(length // 2, 1))
    window = np.hanning(length + 2)[1:-1]
    window = 2.0 * window / window.sum()
    t = np.arange(length) - 0.5 * (length - 1)
    blocks = [np.lib.stride_tricks.sliding_window_view(wave, length)[starts] for wave in waves]
    blocks = [(block - block.mean(axis=1, keepdims=True)) * window for block in blocks]
    tried = np.linspace(1.0 - refine, 1.0 + refine, 41) / period
    turns = np.exp(-2j * np.pi * np.outer(t, tried))
    power = np.zeros((len(starts), len(tried)))
    for wave, block in zip(waves, blocks, strict=True):
        # einsum, as matrix products this small lose more to waiting threads than they gain
        power += np.abs(np.einsum("bt,tf->bf", block, turns)) ** 2 / max(float(np.var(wave)), 1e-300)
    best = np.clip(np.argmax(power, axis=1), 1, len(tried) - 2)
    left, middle, right = (power[np.arange(len(starts)), best + k] for k in (-1, 0, 1))
    bend = left - 2.0 * middle + right
    shift = np.where(bend < 0.0, np.clip(0.5 * (left - right) / np.where(bend < 0.0, bend, 1.0), -1.0, 1.0), 0.0)
    f = tried[best] + shift * (tried[1] - tried[0])
    first = np.exp(-2j * np.pi * np.outer(f, t))
    turned = (first, first * first, first * first * first)
    return tuple(np.array([np.einsum("bt,bt->b", block, each) for each in turned]) for block in blocks)


def harmonics_of(a: Complex) -> Harmonics:
    """The medians over the blocks of amplitudes (3, B)."""
    size = np.abs(a[0])
    c3 = np.cos(np.angle(a[2]) - 3.0 * np.angle(a[0]))
    return Harmonics(float(np.median(np.abs(a[1]) / size)), float(np.median(np.abs(a[2]) / size)), float(np.median(c3)))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(2000.0)
    >>> pv, op = np.tanh(9 * np.sin(t / 12)), 2 * np.abs(2 * ((t / 24 / np.pi) % 1) - 1)
    >>> loop = LoopRecord.from_arrays(t, pv=pv, op=50 + op, sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict, detect(loop).index > 0.95
    ('stiction', True)
    """
    return of_record(p, record, _seen, _judged)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """The amplitudes of OP and PV in every block, real parts and then imaginary ones, (B, 12)."""
    if refusal := refused(CARD, loop, p.c3):
        return refusal
    op, pv = loop.wave("OP", 0.0), loop.wave("PV", 0.0)
    length = round(p.periods * loop.samples_per_period)
    if len(op) < 2 * length:
        reason = (
            f"The longest stretch holds {len(op) / length * p.periods:.1f} cycles; two blocks need {2 * p.periods:g}."
        )
        return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.c3)
    a = np.concatenate(amplitudes((op, pv), length, loop.samples_per_period, p.refine)).T
    step = max(length // 2, 1) * loop.stretch.dt
    middle = loop.stretch.t[0] + 0.5 * (length - 1) * loop.stretch.dt
    return Pool(middle + step * np.arange(len(a)), np.hstack([a.real, a.imag]), float(loop.stretch.t[0]), step)


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    a = (pool.rows[:, :6] + 1j * pool.rows[:, 6:]).T
    a_op, a_pv = a[:3], a[3:]
    of_op, of_pv = harmonics_of(a_op), harmonics_of(a_pv)
    level = bool(loop.integrating)
    index = of_pv.c3 if level else min(of_op.c3, -of_pv.c3)
    word, why = _level(of_op, of_pv, p) if level else _self_regulating(of_op, of_pv, p)
    reason = (
        f"c3 = {of_op.c3:.2f} and h3 = {of_op.h3:.3f} of OP, {of_pv.c3:.2f} and {of_pv.h3:.3f} of PV "
        f"({a_op.shape[1]} blocks, period {loop.period:.4g} s): {why}."
    )
    evidence: dict[str, Values | float] = {"level": float(level)}
    for name, one in (("op", a_op), ("pv", a_pv)):
        ratio = np.conj(one[0] / np.abs(one[0])) ** 3 * one[2] / np.abs(one[0])
        evidence |= {f"{name}_re": ratio.real, f"{name}_im": ratio.imag}
    return Verdict(CARD.name, word, index, p.c3, reason, evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged)


def _self_regulating(op: Harmonics, pv: Harmonics, p: Params) -> tuple[Word, str]:
    if max(op.h2, pv.h2) > p.h2_max:
        return "inconclusive", f"the second harmonic is above {p.h2_max:g}, so the halves of the wave are too unequal"
    if op.c3 >= p.c3 and op.h3 >= p.h3_triangle and pv.c3 <= -p.c3 and pv.h3 >= p.h3_square:
        return "stiction", "OP is triangular while PV is square, as a sticky valve under PI control makes them"
    return "inconclusive", "OP is not triangular while PV is square; dead time, lags and noise hide a sticky valve too"


def _level(op: Harmonics, pv: Harmonics, p: Params) -> tuple[Word, str]:
    if pv.h2 > p.h2_max:
        return "inconclusive", f"the second harmonic is above {p.h2_max:g}, so the halves of the wave are too unequal"
    if pv.c3 < p.c3 or pv.h3 < p.h3_level:
        return "inconclusive", "PV is not triangular; noise and outside waves hide a sticky valve too"
    if op.c3 >= p.c3 and op.h3 >= pv.h3:
        return "inconclusive", "PV is triangular, but OP is more so, which a sticky valve behind it does not explain"
    return "stiction", "PV is triangular and OP less so, as a sticky valve before an integrating process makes them"


def draw(v: Verdict, figure: FigureBase) -> None:
    """a_3 over a_1 of every block in the complex plane, turned so that a triangle lies right and a square left."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.figures import COLOURS
    from stickslip.logs.style import FIT, SOFT

    ax = figure.subplots()
    ax.axhline(0.0, color=SOFT, lw=0.8)
    ax.axvline(0.0, color=SOFT, lw=0.8)
    for name in ("op", "pv"):
        ax.plot(v.array(f"{name}_re"), v.array(f"{name}_im"), "o", ms=5, alpha=0.6, color=COLOURS[name.upper()],
                label=name.upper())  # fmt: skip
    for x, text in ((1 / 9, "triangle"), (-1 / 3, "square"), (0.0, "sine")):
        ax.plot([x], [0.0], "+", ms=12, color=FIT)
        ax.annotate(text, (x, 0.0), (0.0, 8.0), textcoords="offset points", ha="center", fontsize=8)
    ax.set_aspect("equal", adjustable="datalim")
    finish(ax, "third harmonic in phase with the first [-]", "out of phase [-]", "a_3 / a_1 of every block", named=True)
