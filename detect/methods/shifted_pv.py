"""PV a quarter of a period later against OP for integrating loops, an idea of Kvam, NTNU 2009, chapter 7.

The thesis draws OP(t) against PV(t + N), so that the line which a sticky valve before an integrating process draws
opens into a curve, and leaves N to trial.  Rule here: N = period / 4, which turns the half period between the two waves
into a quarter.  Two sines then draw an ellipse, the triangles of a sticky valve a lozenge with four corners.

    index G = A / (2 pi sqrt(det C)),    S = (R + W) / 2

(see ``prepare.pv_op_loops``).  G is 1 for two sines at any phase and 3 / pi = 0.95 for two triangles; simulated sticky
loops had 0.81 to 0.965, sines with up to 40 % noise 0.977 and more.

Source of the idea: Kvam, NTNU 2009, section 7.2; index, size, rule and limits ours.  The weaker of the two ideas,
because a shifted triangle is a triangle still, where ``high_passed_pv`` makes it the square of the valve: waves with a
second harmonic lower G as corners do (10 % of it, far from the opposite phase, gives 0.95), and S is 10 to 25 % low in
simulation. As in ``high_passed_pv``, the flow must stand still while OP travels and the range of OP must repeat.  On
the simulated levels named there: 39 of 64 sticky ones found, 12 of 97 accused under outside squares, none of 100 under
sines, 27 of 46 with a deadband.  A round curve clears nothing.  4 ms for 7,200 prepared samples.
"""

from dataclasses import dataclass, replace

from stickslip.detect.methods import high_passed_pv
from stickslip.detect.methods.high_passed_pv import flow_loops, judged
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.prepare.pv_op_loops import SMOOTHED_AT, loops
from stickslip.detect.verdict import FigureBase, Verdict
from stickslip.logs import LoopRecord

CARD = replace(
    high_passed_pv.CARD,
    name="shifted_pv", title="Shifted PV against OP", source="Kvam, NTNU 2009, section 7.2 (idea)",
    finds="stiction before an integrating process, from the corners of the curve of OP and PV; its apparent amount",
    pros=("works on levels", "gives an amount", "no derivative, so little noise"),
    cons=("a second harmonic looks like corners", "the amount is apparent", "dead time rounds the corners"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Rule and limits, all ours.

    shift : N as a share of the period [-]
    G_stiction : roundness below which the curve has corners [-]
    repeats_min, travel_min : as in ``high_passed_pv.Params`` [-]
    """

    shift: float = 0.25
    G_stiction: float = 0.97
    repeats_min: float = 0.7
    travel_min: float = 0.5


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; refuses any process that is not known to integrate.

    >>> import numpy as np
    >>> t = np.arange(3000.0)
    >>> saw = 2 * np.abs(2 * ((t / 100) % 1) - 1) - 1
    >>> loop = LoopRecord.from_arrays(t, pv=saw, op=50 - 3 * saw, sp=0 * t, process="integrating")
    >>> v = detect(loop)
    >>> v.verdict, 4.5 < v.amount_percent_op < 6.0
    ('stiction', True)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.G_stiction):
        return refusal
    shift = p.shift * loop.period
    found = loops(loop, loop.wave("PV", SMOOTHED_AT), shift)
    rule = high_passed_pv.Params(repeats_min=p.repeats_min, travel_min=p.travel_min)
    how = f"with PV {shift:.4g} s (N = {round(shift / loop.stretch.dt)} samples) later"
    return judged(CARD, loop, found, flow_loops(loop, rule.tau), p.G_stiction, rule, how, draw)


def draw(v: Verdict, figure: FigureBase) -> None:
    """Shifted PV over OP with the ellipse that sines would draw."""
    from stickslip.detect.figures.pv_op import draw_pv_op

    draw_pv_op(v, figure, "PV a quarter of a period later")
