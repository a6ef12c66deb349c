"""Triangle against sine behind the first integrator, He, Wang, Pottmann and Qin 2007.

    SI = E_sine / (E_sine + E_triangle)

Behind a sticky valve MV is nearly a square wave; the first integrator after it makes a triangle of it.  In a
self-regulating loop that integrator is the controller, hence OP is read; with an integrating process it is the process,
hence PV.  E_sine and E_triangle are the mean squared errors of the best sine and of the best triangle, whose apex may
lie anywhere, averaged over the half waves.  SI is 1 for triangles and 0 for sines.

Source: He, Wang, Pottmann and Qin 2007, Ind. Eng. Chem. Res. 46:4549, with the limits 0.4 and 0.6.  Ours: phase-free
smoothing, the interval by weighing the half waves anew, and that an accusation's interval stays above 0.5.

Not for a process of unknown kind: a square wave has SI = 0.44, so PV of a self-regulating loop says nothing. Where the
proportional action rules, OP looks like PV; dead time and slow processes round the triangle, so a sine is not cleared.
Outside waves that are squares or triangles look the same: where they keep time the method refuses
(``oscillation.clock``), and where a historian has drawn OP as straight lines, too.  Of 520 simulated loops ("training",
seed 777001) that leaves 7 of 14 wrong accusations, and 37 of 47 sticky valves found, for 8 of the others OP was stored
as lines.  A dead loop is still accused at times: the controller makes OP from PV there as in any other.
Measured on the prepared record: 1.5 ms for 7,200 samples and 60 cycles, 4 ms for 240 cycles.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.half_waves.half_wave_fits import Samples, free_triangle, sine
from stickslip.detect.methods.against_sine import AgainstSine
from stickslip.detect.pool import Pool, of_record, pooled
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, Signal
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = Card(
    name="curve_fit", title="Curve fit", source="He, Wang, Pottmann and Qin 2007, Ind. Eng. Chem. Res. 46:4549",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "controller with integral action", "constant set point"),
    finds="whether a square wave of the valve is behind the signal after the first integrator; no amount",
    index=(0.0, 1.0), streams="pooled", stream_bound=0.05, cost="O(n)", experimental=True,
    pros=("levels too", "waves with a late apex", "each half wave by itself, so the period may drift"),
    cons=("the kind of process must be known", "outside squares and triangles look the same", "rounded by dead time"),
    needs=("known_process", "oscillation", "own_cycle", "constant_sp", "unsaturated", "raw_op", "follows"),
    cycles=3.0, samples=(12.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of SI [-] as in the paper; fewest half waves [-] (ours)."""

    SI_stiction: float = 0.6
    SI_sine: float = 0.4
    half_waves_min: int = 6


class Errors(NamedTuple):
    """E_sine and E_triangle [unit^2] and the apex [-] of each half wave, each (H,)."""

    sine: Values
    triangle: Values
    apex: Values

    @property
    def SI(self) -> float:
        """SI [-]."""
        return float(_index(np.array([self.sine.mean(), self.triangle.mean()])))


def errors(x: Samples) -> Errors:
    """The errors of the sine and of the triangle with free apex of each half wave.

    >>> phase = (np.arange(4000) + 0.5) / 4000
    >>> late = Samples(phase, np.minimum(phase / 0.9, 10 * (1 - phase)), np.array([0]), np.array([4000.0]))
    >>> found = errors(late)
    >>> round(found.SI, 3), round(float(found.apex[0]), 2)
    (1.0, 0.9)
    """
    bent = free_triangle(x)
    return Errors(sine(x).error, bent.error, bent.parameter)


def _index(means: Values) -> Values:
    return np.asarray(means[..., 0] / np.maximum(means[..., 0] + means[..., 1], 1e-300))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; raises nothing, refuses where the kind of process is unknown.

    >>> t = np.arange(2000.0)
    >>> turns = (t + 3 * np.sin(t / 300)) / 80  # a cycle that strays, as those of loops do
    >>> saw = 2 * np.abs(2 * ((turns + 0.1) % 1) - 1) - 1 + 0.02 * np.sin(t**2)
    >>> pv = np.sin(2 * np.pi * turns)
    >>> loop = LoopRecord.from_arrays(t, pv=pv, op=50 + saw, sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict, detect(loop).index > 0.8
    ('stiction', True)
    """
    return of_record(p, record, _seen, _judged)


def _frame(p: Params, loop: Prepared) -> AgainstSine:
    """The method on the signal behind the first integrator after the valve."""
    signal: Signal = "PV" if loop.integrating else "OP"
    return AgainstSine(
        CARD, "SI", p.SI_stiction, p.half_waves_min, signal, errors, _index, lambda index, low: _word(index, low, p),
        _bent, draw,
    )  # fmt: skip


def _bent(phase: Values, apex: float) -> Values:
    """The triangle of height 1 with its apex at a phase."""
    return np.minimum(phase / apex, (1.0 - phase) / (1.0 - apex))


def _seen(p: Params, loop: Prepared) -> Pool | Verdict:
    return refused(CARD, loop, p.SI_stiction) or _frame(p, loop).seen(loop)


def _judged(p: Params, loop: Prepared, pool: Pool) -> Verdict:
    return _frame(p, loop).judged(loop, pool)


remember, recall = pooled(_seen, _judged)


def _word(index: float, low: float, p: Params) -> tuple[Word, str]:
    if index >= p.SI_stiction and low > 0.5:
        return "stiction", (
            "the half waves are triangles, as an integrator makes them of the square wave of a stuck valve"
        )
    if index <= p.SI_sine:
        return "inconclusive", (
            "the half waves are those of a sine, as an outside wave or tight tuning makes them; dead time or a slow "
            "process rounds the wave of a sticky valve too, so it is not cleared"
        )
    return "inconclusive", f"neither shape fits the half waves much better (limits {p.SI_sine:g} and {p.SI_stiction:g})"


def draw(v: Verdict, figure: FigureBase) -> None:
    """The half waves with the sine and the triangle, and the two errors of each."""
    from stickslip.detect.figures.half_waves import draw_fits

    signal = "PV" if v.evidence.get("of_pv") else "OP"
    draw_fits(v, figure, signal, "triangle", "below the diagonal the triangle fits better")
