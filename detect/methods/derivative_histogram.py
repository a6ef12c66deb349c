"""Histogram of the derivative of PV, Horch 2000 and 2006: a bell points to the valve, two humps to a sine.

    q = MSE_humps / (MSE_bell + MSE_humps)

PV is low-passed at three times the frequency of the oscillation and differentiated: once where the process regulates
itself, twice where it integrates.  A sine stays a sine, whose values crowd at its extremes; the rate of a square wave
(and the second derivative of a triangle) is near zero most of the time.  The histogram of the standardised derivative
is fitted by a Gaussian density and by that of a sine of amplitude A in Gaussian noise s,

    c(x) = (1/pi) integral from 0 to pi of N(x; A cos th, s^2) dth,

and the one with the lesser mean squared error wins: q above 1/2 is stiction.

Source: Horch, PhD thesis, KTH 2000, and Horch 2006 (IFAC ADCHEM); the cut at three times the frequency as the thesis
of Kvam, NTNU 2009, quotes it.  Ours: bins of width 0.2 from -4 to 4; both fits by search on a grid, with A of 1.1 to
1.5 and s of at most 0.5, because a sine drowned in noise is a bell itself; no accusation where noise makes more than a
tenth of the derivative's variance; the lower limit 0.4.

The cut decides: at three times the frequency only the third harmonic is left to tell a square from a sine.  Measured on
loops that stick by 6 %, noise of 0.02 to 0.1 % on PV: q = 0.56 to 0.61 with the published cut, 0.66 to 0.90 with a cut
of 6; a sine 0.02 to 0.1.  A wave that swells and fades, as noise drives a resonance, has a bell too: of 102 such loops
without any valve 97 were accused.  Hence the derivative is taken over its root mean square within a period (ours),
which accused none of them and lost 1 of 44 sticky loops.  A low q clears nothing, because slow processes round the
wave.  The wrong kind of process gives the wrong answer. Measured on the prepared record: 0.4 ms for 7,200 samples, and
20 ms once for the fits.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.smoothing import moving_average
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

EDGES: Values = np.linspace(-4.0, 4.0, 41)  # in standard deviations of the derivative

CARD = Card(
    name="derivative_histogram", title="Histogram of the derivative",
    source="Horch, PhD thesis, KTH 2000; Horch 2006, IFAC ADCHEM",
    signals=("PV",), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "little noise", "constant set point"),
    finds="whether PV (level: its rate) jumps and stays, as behind a sticky valve, or swings like a sine; no amount",
    index=(0.0, 1.0), streams="pooled", stream_bound=0.1, cost="O(n)", experimental=True,
    pros=("needs no OP", "levels too", "no crossings needed"),
    cons=(
        "hangs on its filter", "waves that swell and fade look like stiction", "the kind of process must be known",
        "outside squares look the same",
    ),
    needs=("known_process", "oscillation", "constant_sp", "unsaturated", "fine_pv", "raw_pv"),
    cycles=5.0, samples=(12.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Cut [times the frequency of the oscillation] and upper limit of q [-] as published.

    The lower limit of q and the largest share of noise in the derivative's variance [-] are ours, and so is
    ``even_out``: the derivative is taken over its root mean square within a period, so that its size does not matter.
    """

    cut: float = 3.0
    q_stiction: float = 0.5
    q_sine: float = 0.4
    noise_max: float = 0.1
    even_out: bool = True

    def __post_init__(self) -> None:
        if not self.cut > 1.0:
            raise ValueError(f"cut = {self.cut} times the frequency; give more than 1, or the wave itself is cut off")


class Humps(NamedTuple):
    """q [-], the density (40,) and both fits (40,), amplitude A and noise s of the sine [standard deviations]."""

    q: float
    density: Values
    bell: Values
    humps: Values
    amplitude: float
    noise: float


@lru_cache(maxsize=1)
def _shapes() -> tuple[Values, Values, Values]:
    """Bells (B, 40), humps (C, 40), and amplitude and noise of the humps (C, 2), as means over the bins."""
    from scipy.special import ndtr

    width = EDGES[1] - EDGES[0]
    bells = [np.diff(ndtr((EDGES - m) / s)) for m in np.linspace(-0.5, 0.5, 11) for s in np.geomspace(0.15, 1.5, 40)]
    turn = np.cos(np.pi * (np.arange(64) + 0.5) / 64)
    settings = [(A, s) for A in np.linspace(1.1, 1.5, 20) for s in np.geomspace(0.05, 0.5, 16)]
    humps = [np.diff(ndtr((EDGES[:, None] - A * turn) / s).mean(axis=1)) for A, s in settings]
    return np.array(bells) / width, np.array(humps) / width, np.array(settings)


def bell_or_humps(x: Values) -> Humps:
    """Whether values (n,) are spread like a Gaussian (q near 1) or like a sine in noise (q near 0).

    >>> round(bell_or_humps(np.sin(np.arange(5000.0))).q, 1)
    0.0
    >>> bell_or_humps(np.random.default_rng(0).normal(size=5000)).q > 0.7
    True
    """
    z = (x - x.mean()) / x.std()
    return fitted(np.histogram(z, EDGES)[0] / len(z) / (EDGES[1] - EDGES[0]))


def fitted(density: Values) -> Humps:
    """The best bell and the best humps for a density (40,) over ``EDGES``."""
    bells, humps, settings = _shapes()
    of_bell, of_humps = ((bells - density) ** 2).mean(axis=1), ((humps - density) ** 2).mean(axis=1)
    bell, hump = int(np.argmin(of_bell)), int(np.argmin(of_humps))
    q = float(of_humps[hump] / max(of_humps[hump] + of_bell[bell], 1e-300))
    return Humps(q, density, bells[bell], humps[hump], float(settings[hump, 0]), float(settings[hump, 1]))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; refuses where the kind of process is unknown.

    >>> t = np.arange(3000.0)
    >>> square = np.tanh(9 * np.sin(t / 12.7)) + 0.01 * np.sin(t**2)
    >>> loop = LoopRecord.from_arrays(t, pv=square, op=50 + np.cos(t / 12.7), sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict
    'stiction'
    """
    return of_record(p, record, _seen, _judged)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    """How many values of the derivative fall into each bin, and the share of noise, for each period."""
    if refusal := refused(CARD, loop, p.q_stiction):
        return refusal
    x, t = loop.wave("PV", p.cut), loop.stretch.t
    order = _order(loop)
    for _ in range(order):
        x = np.gradient(x, loop.stretch.dt)
    share = noise_share(loop, p.cut, order, float(np.var(x)))
    if p.even_out:
        x = x / np.sqrt(moving_average(t, x * x, loop.period, ends="hold"))
    edge = round(0.5 * loop.samples_per_period)
    x, t = x[edge:-edge], t[edge:-edge]
    z = (x - x.mean()) / x.std()
    parts = max(round((t[-1] - t[0]) / loop.period), 1)
    counts = [np.histogram(part, EDGES)[0] for part in np.array_split(z, parts)]
    at = np.array([0.5 * (part[0] + part[-1]) for part in np.array_split(t, parts)])
    sizes = [len(part) for part in np.array_split(z, parts)]
    return Pool(at, np.column_stack([counts, sizes, np.full(parts, share)]), float(t[0]), loop.period)


def _order(loop: Prepared) -> int:
    """How often PV is differentiated."""
    return 2 if loop.integrating else 1


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    order, share = _order(loop), float(pool.rows[:, -1].mean())
    counts = pool.rows[:, :-2].sum(axis=0)
    found = fitted(counts / pool.rows[:, -2].sum() / (EDGES[1] - EDGES[0]))
    word, why = _word(found, share, p)
    reason = (
        f"q = {found.q:.2f} for {'the second derivative' if order == 2 else 'the derivative'} of PV, cut at {p.cut:g} "
        f"times the frequency (period {loop.period:.4g} s): {why}."
    )
    evidence: dict[str, Values | float] = {
        "x": 0.5 * (EDGES[1:] + EDGES[:-1]), "density": found.density, "bell": found.bell, "humps": found.humps,
        "A": found.amplitude, "s": found.noise, "order": float(order), "noise_share": share,
    }  # fmt: skip
    return Verdict(CARD.name, word, found.q, p.q_stiction, reason, evidence=evidence, draw=draw)


remember, recall = pooled(_seen, _judged, most=100)


def noise_share(loop: Prepared, cut: float, order: int, variance: float) -> float:
    """Share of a derivative's variance that is white noise of PV after the low-pass [-].

    The filter runs to and fro, so its gain is 1 / (1 + x^4), x = tan(w / 2) / tan(w_c / 2) at w = 2 pi f dt; the
    central difference has the gain sin(w) / dt.
    """
    w = np.linspace(0.0, np.pi, 2000, endpoint=False)
    x = np.tan(0.5 * w) / math.tan(math.pi * cut / loop.samples_per_period)
    gain = (np.sin(w) / loop.stretch.dt) ** order / (1.0 + x**4)
    return float(loop.noise("PV") ** 2 * np.mean(gain**2) / max(variance, 1e-300))


def _word(found: Humps, share: float, p: Params) -> tuple[Word, str]:
    if share > p.noise_max:
        return "inconclusive", (
            f"noise makes {share:.0%} of its variance ({p.noise_max:.0%} allowed), and noise is a bell"
        )
    if found.q > p.q_stiction:
        return "stiction", "a bell fits it better than two humps, as where PV jumps and stays"
    if found.q < p.q_sine:
        return "inconclusive", (
            "two humps fit it better than a bell, as those of a sine; noise and slow processes make them of the wave "
            "of a sticky valve too, so it is not cleared"
        )
    return "inconclusive", f"neither fits it much better (limits {p.q_sine:g} and {p.q_stiction:g})"


def draw(v: Verdict, figure: FigureBase) -> None:
    """The histogram with the bell and the two humps."""
    from stickslip.detect.figures.half_waves import OTHER, SINE, WAVE
    from stickslip.detect.figures.verdict import finish

    ax = figure.subplots()
    x = v.array("x")
    ax.bar(x, v.array("density"), width=x[1] - x[0], color=WAVE)
    ax.plot(x, v.array("bell"), color=OTHER, lw=1.6, label="bell")
    ax.plot(x, v.array("humps"), color=SINE, lw=1.6, ls="--", label="humps of a sine")
    below = f"derivative {v.array('order')[0]:.0f} of PV [standard deviations]"
    finish(ax, below, "density [-]", "values of the derivative", named=True)
