"""Relay wave against sine, Rossi and Scali 2005: a sticky valve acts on the process as a relay does.

    S_I = (E_S - E_RT) / (E_S + E_RT)

E_S is the mean squared error of the best sine of a half wave of PV, E_RT that of the best relay wave or triangle,
whichever is less, both averaged over the half waves.  S_I is +1 for a wave that a relay can make and -1 for a sine.
The relay waves are those of a first-order process with dead time; 25 ratios of dead time to time constant from 0.05
(nearly a triangle) to 30 (nearly a square) are tried, so that the method suits integrating processes too.

Source: Rossi and Scali 2005, J. Process Control 15:505.  The limits +-0.21 are those quoted from the paper: the errors
differ by the factor 1.53.  Ours: phase-free smoothing of PV, the interval by drawing the half waves anew, and the
demand that an accusation's interval stays above zero.

A sine is not cleared: noise draws S_I to 0, and slow processes behind a sticky valve turn every wave into a sine.
An outside wave that is a square or a triangle looks the same; where it keeps time (``oscillation.clock``) or PV does
not follow OP the method refuses (of 520 simulated loops, "training", seed 777001, 66 sticky valves found as before, 5
wrong accusations where 10 were); a triangle with its apex near an end (0.9) has S_I = 0.2.
Measured on the prepared record: 2 ms for 7,200 samples and 60 cycles, 4 ms for 240 cycles.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.half_waves.half_wave_fits import Samples, relay, relay_wave, sine, triangle
from stickslip.detect.methods.against_sine import AgainstSine
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="relay_fit", title="Relay fit", source="Rossi and Scali 2005, J. Process Control 15:505",
    signals=("PV",), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "OP not at a limit", "constant set point"),
    finds="whether a relay, as a sticky valve is one, could have made the wave of PV; no amount",
    index=(-1.0, 1.0), streams="pooled", stream_bound=0.05, cost="O(25 n)", experimental=True,
    pros=("any process", "needs no OP", "each half wave by itself, so the period may drift"),
    cons=("noise draws it to 0", "outside squares and triangles look the same", "blind to waves with a late apex"),
    needs=("oscillation", "own_cycle", "constant_sp", "unsaturated", "fine_pv", "raw_pv", "follows"),
    cycles=3.0, samples=(12.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of S_I [-] as quoted from the paper; fewest half waves [-] (ours)."""

    S_stiction: float = 0.21
    S_sine: float = -0.21
    half_waves_min: int = 6


class Errors(NamedTuple):
    """E_S and E_RT of each half wave [unit^2], and theta / tau of its relay wave [-] (0: triangle), each (H,)."""

    sine: Values
    relay: Values
    ratio: Values

    @property
    def S_I(self) -> float:
        """S_I [-]."""
        return float(_index(np.array([self.sine.mean(), self.relay.mean()])))


def errors(x: Samples) -> Errors:
    """The errors of the sine and of the relay wave or triangle of each half wave.

    >>> phase = (np.arange(4000) + 0.5) / 4000
    >>> square = Samples(phase, np.ones(4000), np.array([0]), np.array([4000.0]))
    >>> round(errors(square).S_I, 3)
    0.769
    """
    straight, curved = triangle(x), relay(x)
    better = curved.error < straight.error
    return Errors(
        sine(x).error, np.where(better, curved.error, straight.error), np.where(better, curved.parameter, 0.0)
    )


def _index(means: Values) -> Values:
    a, b = means[..., 0], means[..., 1]
    return np.asarray((a - b) / np.maximum(a + b, 1e-300))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> t = np.arange(2000.0)
    >>> saw = 2 * np.abs(2 * ((t / 80 + 0.1) % 1) - 1) - 1
    >>> pv = saw + 0.02 * np.sin(t**2)
    >>> loop = LoopRecord.from_arrays(t, pv=pv, op=50 - saw, sp=0 * t, process="integrating")
    >>> detect(loop).verdict, detect(loop).index > 0.7
    ('stiction', True)
    """
    return of_record(p, record, _seen, _judged)


def _frame(p: Params) -> AgainstSine:
    return AgainstSine(
        CARD, "S_I", p.S_stiction, p.half_waves_min, "PV", errors, _index, lambda index, low: _word(index, low, p),
        _shape, draw,
    )  # fmt: skip


def _shape(phase: Values, ratio: float) -> Values:
    """The relay wave of a ratio of dead time to time constant; the triangle for 0."""
    return relay_wave(phase, ratio) if ratio > 0.0 else 1.0 - np.abs(2.0 * phase - 1.0)


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    return _frame(p).seen(loop)


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    return _frame(p).judged(loop, pool)


remember, recall = pooled(_seen, _judged)


def _word(index: float, low: float, p: Params) -> tuple[Word, str]:
    if index > p.S_stiction and low > 0.0:
        return "stiction", "the half waves are those that a relay makes, as a sticky valve is one"
    if index < p.S_sine:
        return "inconclusive", (
            "the half waves are those of a sine, as an outside wave or tight tuning makes them; a slow process or "
            "noise hides a sticky valve behind such a wave too, so it is not cleared"
        )
    return "inconclusive", f"neither shape fits the half waves much better (limits {p.S_sine:g} and {p.S_stiction:g})"


def draw(v: Verdict, figure: FigureBase) -> None:
    """The half waves of PV with the sine and the relay wave, and the two errors of each."""
    from stickslip.detect.figures.half_waves import draw_fits

    draw_fits(v, figure, "PV", "relay wave", "below the diagonal the relay wave fits better")
