"""Two-band sticky valve of the published flow chart, sampled (Choudhury, Thornhill & Shah 2005).

    v = sgn(OP - OP before)
    v = 0       a moving valve sticks at x_ss = OP before; J frees it in any direction that keeps its sign
    v turned    it sticks at x_ss = OP before; S frees it
    moving      MV = OP - v (S - J)/2;  a stuck valve moves once |OP - x_ss| exceeds its band

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
S    deadband plus stickband, J slip jump [unit of OP], 0 <= J <= S          dt  sampling period [s]
low, high  ends of the span [unit of OP]; -inf and inf lift them

Source: M. A. A. S. Choudhury, N. F. Thornhill, S. L. Shah, Modelling valve stiction, Control Engineering Practice
13 (2005) 641-658.
Choices of this page.  The flow chart has no memory of moving and can fall back to stuck right after a move by J;
a flag mends that.  Ends of the span and the start are treated as in kano_valve.
Valid for smooth or stepwise OP.  Not for noisy OP: every turn of OP, even of a stuck valve, begins the S anew.
See also: kano_valve.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.sampled_valve import TwoBandValve

STANDS, TURNED, FRESH = 1.0, 0.0, 2.0  # why the valve is stuck: OP stood still, OP turned, never moved


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    S, J, low, high = p[0], p[1], p[2], p[3]
    kinetic = 0.5 * (S - J)
    moving, x_ss, why, v_before, u_before = d[0], d[1], d[2], d[3], d[5]  # d[4] is MV
    op = u[0]
    if op >= high or op <= low:
        v_before = 1.0 if op >= high else -1.0
        d[4] = high if op >= high else low
        moving = 0.0
        op = d[4] + v_before * kinetic  # the OP that would have pushed the stem here
    elif op == u_before:
        if moving == 1.0:
            moving = 0.0
            why = STANDS
            x_ss = u_before
    else:
        v = math.copysign(1.0, op - u_before)
        if v_before != 0.0 and v != v_before:
            moving = 0.0
            why = TURNED
            x_ss = u_before
        band = J if why == STANDS else (S if why == TURNED else 0.5 * (S + J))
        if moving == 0.0 and abs(op - x_ss) > band:
            moving = 1.0
        if moving == 1.0:
            d[4] = op - v * kinetic
        v_before = v
    d[0] = moving
    d[1] = x_ss
    d[2] = why
    d[3] = v_before
    d[5] = op
    y[0] = d[4]


class ChoudhuryValve(TwoBandValve):
    """The sampled valve of Choudhury et al. with ``S`` and ``J`` [unit of OP] and sampling period ``dt`` [s].

    ``start`` is where OP and MV stand before the first sample.  Raises ``BlockError`` unless
    0 <= J <= S <= high - low and dt > 0.

    >>> from stickslip.diagram import drive
    >>> valve = ChoudhuryValve(S=0.06, J=0.02, dt=1.0, start=0.5)
    >>> drive(valve, 4.0, every=1.0, OP=([0, 1, 2, 3, 4], [0.5, 0.53, 0.56, 0.59, 0.54])).log["MV"].round(3).tolist()
    [0.5, 0.5, 0.54, 0.57, 0.57]
    """

    kernels = Kernels(step=_step)

    @staticmethod
    def memory_at(start: float) -> Mapping[str, float]:
        """Return the memory of a valve at rest at ``start``."""
        return {"moving": 0.0, "x_ss": start, "why": FRESH, "v": 0.0, "MV": start, "OP": start}
