"""Two-band sticky valve with a state machine, sampled (Kano, Maruta, Kugemoto & Shimizu 2004).

    on the move   MV = OP - dir (S - J)/2;  it sticks at u_s, the OP of the last sample, once OP stops or turns
    stuck         MV held until OP has left u_s by more than S against dir, or by more than J along dir

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
S    deadband plus stickband, J slip jump [unit of OP], 0 <= J <= S          dt  sampling period [s]
low, high  ends of the span [unit of OP]; -inf and inf lift them

Source: M. Kano et al., Practical model and detection algorithm for valve stiction, IFAC DYCOPS 2004.
Choices of this page.  At an end of the span the stem is put on its stop and the bands are those of a stem pushed
there; before its first move dir is unknown and the valve breaks away at (S + J)/2 from its start.
Valid for smooth or stepwise OP.  Not for noisy OP, which stops and starts it at every sample: use he_valve,
chen_valve or quasi_static_stem.  See also: choudhury_valve, which makes the same moves on ramps.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.sampled_valve import TwoBandValve


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    S, J, low, high = p[0], p[1], p[2], p[3]
    kinetic = 0.5 * (S - J)
    stuck, u_s, direction, u_before = d[0], d[1], d[2], d[4]  # d[3] is MV
    op = u[0]
    if op >= high or op <= low:
        direction = 1.0 if op >= high else -1.0
        d[3] = high if op >= high else low
        stuck = 1.0
        op = d[3] + direction * kinetic  # the OP that would have pushed the stem here
        u_s = op
    else:
        if stuck == 0.0 and (op - u_before) * direction <= 0.0:
            u_s = u_before
            stuck = 1.0
        if stuck == 1.0:
            moved = op - u_s
            if direction == 0.0:
                if abs(moved) > 0.5 * (S + J):
                    direction = math.copysign(1.0, moved)
                    stuck = 0.0
            elif -direction * moved > S:
                direction = -direction
                stuck = 0.0
            elif direction * moved > J:
                stuck = 0.0
        if stuck == 0.0:
            d[3] = op - direction * kinetic
    d[0] = stuck
    d[1] = u_s
    d[2] = direction
    d[4] = op
    y[0] = d[3]


class KanoValve(TwoBandValve):
    """The sampled valve of Kano et al. with the bands ``S`` and ``J`` [unit of OP] and sampling period ``dt`` [s].

    ``start`` is where OP and MV stand before the first sample.  Raises ``BlockError`` unless
    0 <= J <= S <= high - low and dt > 0.

    >>> from stickslip.diagram import drive
    >>> valve = KanoValve(S=0.06, J=0.02, dt=1.0, start=0.5)
    >>> drive(valve, 4.0, every=1.0, OP=([0, 1, 2, 3, 4], [0.5, 0.53, 0.56, 0.59, 0.54])).log["MV"].round(3).tolist()
    [0.5, 0.5, 0.54, 0.57, 0.57]
    """

    kernels = Kernels(step=_step)

    @staticmethod
    def memory_at(start: float) -> Mapping[str, float]:
        """Return the memory of a valve at rest at ``start``."""
        return {"stuck": 1.0, "u_s": start, "dir": 0.0, "MV": start, "OP": start}
