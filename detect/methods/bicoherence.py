"""Bicoherence of the control error, and the width of the PV-OP curve: is the loop non-linear, and by how much of OP?

    bic^2(f1, f2) = |mean X(f1) X(f2) X*(f1 + f2)|^2 / (mean |X(f1) X(f2)|^2 mean |X(f1 + f2)|^2 + eps)
    NGI = mean of bic^2 over its significant points - c,     c = chi2(0.95, 2) / (2 K)
    NLI = |max bic^2 - (mean + 2 std)|, mean and std without the top and bottom tenth

over K segments of 64 samples, half overlapping, under a Hann window, DFT of 128 points; eps is the 75 % quantile of the
denominators. A linear loop moved by Gaussian noise has neither; NGI alone above zero is non-Gaussian but linear, both
are non-linear. Published limits (0.001 and 0.01) pass a clean sine, because a cyclic record fills its segments with the
same few lines; hence each index must also exceed 95 % of the values of the record's own linear twins
(``signals.surrogates``), which have the same lines and other phases.

Non-linear is not yet sticky. The second stage filters PV and OP to the coupled frequencies, fits an ellipse to the
PV-OP curve of the most regular cycles and takes its chord along OP at the centre,

    apparent stiction = 2 m n / sqrt(m^2 sin^2 a + n^2 cos^2 a)         (semi-axes m, n; angle a of m to the OP axis)

or, where the curve is no ellipse, the distance of two clusters of OP in a strip about mean PV. It is apparent, because
controller and process change the width too; above 0.5 % of OP and three times the noise it counts as stiction.

Source: Choudhury, Shah and Thornhill 2004, Automatica 40:1719 (indices); Choudhury, Thornhill and Shah 2005 and
Choudhury et al. 2006, Control Eng. Practice 13:641, 14:1395 (ellipse, clusters). Segments, limits and eps are taken
from secondary sources; the twins and the measure of the ellipse's fit are ours. A patent on the method was published:
US 2007/0288103.

Measured: of 40 loops under an outside sine 1 was called sticky, of 40 noisy sines and 40 narrow-band noises none; of 80
simulated loops that cycle by a valve with S = 6 % 42, with an apparent stiction of 4.1 to 4.8 %: a low power. About 50
to 150 ms a record.

Blind on symmetric waves, whose even harmonics vanish: nothing is cleared. Not for levels, where the curve is a line. An
outside wave that is no sine (a saw) is as non-linear as a valve, and its ellipse as wide.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.surrogates import end_matched, phase_randomised
from stickslip.detect.stem.recent import blocks
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

LENGTH, POINTS = 64, 128  # of a segment and of its DFT, as in the paper
CHI2 = 5.991464547107979  # 95 % of chi squared with two degrees of freedom

CARD = Card(
    name="bicoherence", title="Bicoherence and PV-OP ellipse",
    source="Choudhury, Shah and Thornhill 2004, Automatica 40:1719; 2006, Control Eng. Practice 14:1395",
    signals=("SP", "PV", "OP"), process=("self_regulating",),
    assumes=(
        "locally linear process", "no non-linear disturbance", "constant set point", "a wave that is not symmetric",
    ),
    finds="whether the loop is non-linear (NLI), and the apparent stiction [% of OP]",
    index=(0.0, 1.0), streams="window", cost="O(n) for 1000 pairs of frequencies, 40 times", experimental=True,
    stream_note="The spectra are averages over segments of one record, whose length follows from its period.",
    pros=(
        "separates a linear loop from a non-linear one", "sizes what it finds",
        "calibrated on the record's own spectrum",
    ),
    cons=("long records", "blind on symmetric waves", "any non-linearity counts", "the size is apparent"),
    needs=("oscillation", "constant_sp", "unsaturated", "raw_pv", "fine_pv"),
    cycles=12.0, samples=(10.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings; where no paper is named they are ours.

    ngi_min, nli_min : limits of the paper [-], beside those of the twins
    twins : linear twins of the record
    level : share of the twins that must lie below
    per_period, samples : most samples of a period (of the paper: two periods must fit into a segment) and of the record
    segments : fewest segments
    amount_min : least apparent stiction [% of OP]
    noise_min : least apparent stiction in standard deviations of the noise on OP
    fit_min : least fit of the ellipse [-]; below it the clusters are taken
    """

    ngi_min: float = 0.001
    nli_min: float = 0.01
    twins: int = 39
    level: float = 0.95
    per_period: int = 16
    samples: int = 4096
    segments: int = 8
    amount_min: float = 0.5
    noise_min: float = 3.0
    fit_min: float = 0.8


class Bicoherence(NamedTuple):
    """bic^2 on the principal triangle, shape (m,), its frequencies (m,) [cycles / sample], NGI and NLI [-]."""

    squared: Values
    f1: Values
    f2: Values
    ngi: float
    nli: float

    @property
    def peak(self) -> tuple[float, float]:
        """The most coupled pair of frequencies [cycles / sample]."""
        top = int(np.argmax(self.squared))
        return float(self.f1[top]), float(self.f2[top])


class Ellipse(NamedTuple):
    """Centre, semi-axes m >= n, angle of m to the first axis [rad], and fit [-]: 1 is exact, 0 is a blot."""

    centre: tuple[float, float]
    m: float
    n: float
    angle: float
    fit: float

    @property
    def chord(self) -> float:
        """Width along the first axis through the centre."""
        return 2.0 * self.m * self.n / math.hypot(self.m * math.sin(self.angle), self.n * math.cos(self.angle))


def bicoherence(x: Values) -> Bicoherence:
    """The bicoherence of x (n,), n at least one segment.

    Two lines and their sum, phases tied: coupled; with the phase of the sum drawn anew in every segment: not.

    >>> rng = np.random.default_rng(0)
    >>> a, b, c = rng.uniform(0, 2 * np.pi, (3, 64, 1))
    >>> t = 2 * np.pi * np.arange(64)
    >>> tied, free = (np.cos(0.11 * t + a) + np.cos(0.07 * t + b) + np.cos(0.18 * t + s) for s in (a + b, c))
    >>> bicoherence(tied.ravel()).nli > 3 * bicoherence(free.ravel()).nli
    True
    """
    parts = np.lib.stride_tricks.sliding_window_view(x, LENGTH)[:: LENGTH // 2]
    parts = (parts - parts.mean(axis=1, keepdims=True)) * np.hanning(LENGTH)
    lines = np.fft.rfft(parts, POINTS, axis=1)
    i, j = np.meshgrid(np.arange(1, POINTS // 2), np.arange(1, POINTS // 2), indexing="ij")
    i, j = (each[(j <= i) & (i + j < POINTS // 2)] for each in (i, j))
    pair, both = lines[:, i] * lines[:, j], lines[:, i + j]
    power = np.mean(np.abs(pair) ** 2, axis=0) * np.mean(np.abs(both) ** 2, axis=0)
    squared = np.abs(np.mean(pair * both.conj(), axis=0)) ** 2 / (power + np.percentile(power, 75.0) + 1e-300)
    limit = CHI2 / (2.0 * len(parts))
    significant = squared[squared > limit]
    ngi = (float(np.mean(significant)) if len(significant) else 0.0) - limit
    trimmed = np.sort(squared)[len(squared) // 10 : -(len(squared) // 10)]
    nli = abs(float(np.max(squared) - np.mean(trimmed) - 2.0 * np.std(trimmed)))
    return Bicoherence(squared, i / POINTS, j / POINTS, ngi, nli)


def ellipse(x: Values, y: Values) -> Ellipse | None:
    """The ellipse of least squares through points (n,) (Fitzgibbon 1999, in the form of Halir and Flusser 1998).

    >>> a = np.linspace(0, 2 * np.pi, 100)
    >>> found = ellipse(3 * np.cos(a) + 1, 2 * np.sin(a))
    >>> round(found.m, 6), round(found.n, 6), round(found.chord, 6)
    (3.0, 2.0, 6.0)
    """
    x_0, y_0 = float(np.mean(x)), float(np.mean(y))
    u, v = x - x_0, y - y_0
    square, line = np.stack([u * u, u * v, v * v], axis=1), np.stack([u, v, np.ones_like(u)], axis=1)
    try:
        tied = -np.linalg.solve(line.T @ line, line.T @ square)
        reduced = square.T @ square + square.T @ line @ tied
        _, vectors = np.linalg.eig(np.array([reduced[2] / 2.0, -reduced[1], reduced[0] / 2.0]))
    except np.linalg.LinAlgError:
        return None
    vectors = np.real(vectors)
    inside = 4.0 * vectors[0] * vectors[2] - vectors[1] ** 2
    if not np.max(inside) > 0.0:
        return None
    a, b, c = vectors[:, int(np.argmax(inside))]
    d, e, f = tied @ np.array([a, b, c])
    form = np.array([[a, b / 2.0], [b / 2.0, c]])
    centre = np.linalg.solve(form, [-d / 2.0, -e / 2.0])
    level = float(centre @ form @ centre - f)
    values, axes = np.linalg.eigh(form / level) if level != 0.0 else (np.array([-1.0]), form)
    if not np.all(values > 0.0):
        return None
    points = np.stack([u, v], axis=1) - centre
    radius = np.einsum("ij,jk,ik->i", points, form / level, points)
    m, n = 1.0 / math.sqrt(values[0]), 1.0 / math.sqrt(values[1])
    if m > max(np.ptp(x), np.ptp(y)):
        return None  # a line, or an arc of a far larger ellipse
    fit = 1.0 - float(np.mean((radius - 1.0) ** 2))
    return Ellipse((x_0 + centre[0], y_0 + centre[1]), m, n, math.atan2(axes[1, 0], axes[0, 0]), fit)


def clusters(op: Values, pv: Values, strip: float = 0.1) -> tuple[float, float]:
    """Two means of OP (n,) where PV is within ``strip`` of its range about its mean: the sides of the PV-OP curve.

    >>> a = np.linspace(0, 2 * np.pi, 500)
    >>> [abs(round(side, 1)) for side in clusters(3 * np.cos(a), np.sin(a))]
    [3.0, 3.0]
    """
    near = op[np.abs(pv - np.mean(pv)) < strip * np.ptp(pv)]
    if len(near) < 2:
        return math.nan, math.nan
    low, high = float(np.min(near)), float(np.max(near))
    for _ in range(50):
        upper = near > 0.5 * (low + high)
        if upper.all() or not upper.any():
            break
        sides = float(np.mean(near[~upper])), float(np.mean(near[upper]))
        if sides == (low, high):
            break
        low, high = sides
    return low, high


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; the twins are the same at every call.

    >>> t = np.arange(4000.0)
    >>> sine = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t)
    >>> detect(sine).verdict
    'inconclusive'
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.nli_min):
        return refusal
    each = max(1, math.ceil(loop.samples_per_period / p.per_period))
    e, op, pv = (blocks(loop.signal(name)[: each * p.samples], each) for name in ("E", "OP", "PV"))
    period = loop.samples_per_period / each
    part = end_matched(e, period)
    x = e[part]
    segments = max(len(x) - LENGTH, 0) // (LENGTH // 2) + 1
    if segments < p.segments:
        return Verdict.not_applicable(
            CARD.name, "too_few_cycles",
            f"At {period:.0f} samples a period the record makes {segments} segments of {LENGTH} samples; "
            f"{p.segments} are needed, {(p.segments + 1) * LENGTH / 2 / period + 3:.0f} cycles.", p.nli_min,
        )  # fmt: skip
    found = bicoherence(x)
    twins = [bicoherence(y) for y in phase_randomised(x, p.twins, np.random.default_rng(0))]
    ngi_limit = max(p.ngi_min, float(np.quantile([twin.ngi for twin in twins], p.level)))
    nli_limit = max(p.nli_min, float(np.quantile([twin.nli for twin in twins], p.level)))
    numbers = f"NGI = {found.ngi:.3f} (limit {ngi_limit:.3f}), NLI = {found.nli:.3f} (limit {nli_limit:.3f})"
    evidence: dict[str, Values | float] = {
        "f1": found.f1, "f2": found.f2, "squared": found.squared, "ngi": found.ngi, "ngi_limit": ngi_limit,
        "twins": np.array([twin.nli for twin in twins]),
    }  # fmt: skip

    def say(word: Word, why: str, amount: float | None = None) -> Verdict:
        reason = f"{numbers}: {why}."
        return Verdict(
            CARD.name, word, found.nli, nli_limit, reason, amount_percent_op=amount, evidence=evidence, draw=draw
        )

    if found.ngi <= ngi_limit or found.nli <= nli_limit:
        kind = "no more than a linear loop with these lines" if found.ngi <= ngi_limit else "not Gaussian, but linear"
        return say("inconclusive", f"{kind}; a symmetric wave of a sticky valve hides from it, so it is not cleared")
    op, pv = (_coupled(signal[part], *found.peak, period) for signal in (op, pv))
    few = _most_regular(pv, period)
    op, pv = op[few], pv[few]
    width, how = _width(op, pv, p.fit_min)
    evidence |= {"op": op, "pv": pv, "width": width}
    percent = loop.op_percent(width)
    scale, unit = loop.op_unit
    size = f"the {how} of the PV-OP curve is {scale * width:.2g} {unit} wide"
    least = max(p.noise_min * loop.noise("OP"), 0.1 * float(np.ptp(op)))
    if width < least or (percent is not None and percent < p.amount_min):
        return say("inconclusive", f"non-linear, but {size}, which is no stiction: look at process and sensor")
    return say("stiction", f"non-linear, and {size} (apparent stiction)", percent)


def _width(op: Values, pv: Values, fit_min: float) -> tuple[float, str]:
    """Apparent stiction [unit of OP], and what it was read from."""
    scale = float(np.std(pv)) / max(float(np.std(op)), 1e-300)
    found = ellipse(op * scale, pv)
    if found is not None and found.fit >= fit_min:
        return found.chord / scale, "ellipse"
    low, high = clusters(op, pv)
    return (high - low, "pair of clusters") if math.isfinite(high - low) else (0.0, "pair of clusters")


def _coupled(x: Values, f1: float, f2: float, period: float) -> Values:
    """What x has between the coupled frequencies, 0.05 cycles a sample further at either side; without phase.

    The paper's band may lie above the wave itself where harmonics are coupled; the wave is always kept.
    """
    lines = np.fft.rfft(x - np.mean(x))
    f = np.fft.rfftfreq(len(x))
    low = max(0.004, min(min(f1, f2) - 0.05, 0.5 / period))
    lines[(f < low) | (f > min(0.5, f1 + f2 + 0.05))] = 0.0
    return np.asarray(np.fft.irfft(lines, len(x)))


def _most_regular(x: Values, period: float, cycles: float = 8.0) -> slice:
    """The stretch of so many periods [samples] whose cycles are most alike."""
    shift, length = round(period), round(cycles * period)
    if len(x) <= length + shift:
        return slice(0, len(x))
    starts = range(0, len(x) - length - shift, max(shift // 2, 1))
    alike = [float(np.corrcoef(x[a : a + length], x[a + shift : a + shift + length])[0, 1]) for a in starts]
    best = starts[int(np.argmax(alike))]
    return slice(best, best + length)


def draw(v: Verdict, figure: FigureBase) -> None:
    """bic^2 over both frequencies, NLI among its twins, and the PV-OP curve where it was measured."""
    from stickslip.detect.figures.bicoherence import draw_bicoherence

    draw_bicoherence(v, figure)
