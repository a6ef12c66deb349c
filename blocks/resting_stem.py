"""The sticky stem without mass that sticks anew whenever OP stands still, as it does between the scans of a controller.

    stuck    x held while |OP - x| <= f_s; then it slips to OP - dir f_c, dir = sgn(OP - x)
    sliding  x = OP - dir f_c while dir dOP/dt > 0; where OP stands still or turns, it sticks where it is

    f_s = (S + J)/2,   f_c = (S - J)/2

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
S    movement of OP after a reversal until the stem breaks away [fraction of OP]
J    jump when it breaks away [fraction of OP], 0 <= J <= S
low, high  end stops [fraction of travel]; -inf and inf lift them

It differs from ``quasi_static_stem`` behind a held OP only.  That one slides on at the next scan without a new jump;
this one has to break away again, so that it moves in jumps of at least J.  So does a stem with mass that comes to rest
between scans (``stick_slip``), and so do those of He and Kano.  For J = 0 both are the same.
A jump of OP ends at rest, whatever OP does behind it.
Source: He, Wang, Pottmann and Qin, Ind. Eng. Chem. Res. 46 (2007) 4549-4560, for an OP that is held.
See also: he_valve (the same, sampled at a period of its own).
"""

from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.quasi_static_stem import CREEP, QuasiStaticStem, event_functions, position, transition
from stickslip.blocks.seen_stem import DOWN, UP


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    event_functions(t, x, d, u, p, g)
    if d[0] == UP or d[0] == DOWN:
        g[0] = CREEP - d[0] * u[1]


class RestingStem(QuasiStaticStem):
    """A massless valve stem that sticks anew under an OP that stands still.

    ``start``: where the stem rests at the start [fraction of travel].
    Raises ``BlockError`` unless 0 <= J <= S and the stops are in order.

    >>> from stickslip.blocks import Recorded
    >>> from stickslip.diagram import simulate, wire
    >>> OP = Recorded("OP", [0, 1, 2, 3], [0.0, 0.05, 0.06, 0.1], hold="previous")
    >>> valve = RestingStem(S=0.06, J=0.02)  # f_s = 0.04, f_c = 0.02
    >>> simulate(wire([OP, valve]), 3.0, every=1.0).log["MV"].round(3).tolist()
    [0.0, 0.03, 0.03, 0.08]
    """

    kernels = Kernels(
        out=position, zc=_zc, jump=transition, n_events=2, rates=True, rate_modes=(UP, DOWN), jumps=True, linear=True
    )
