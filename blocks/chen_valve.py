"""Sticky valve as a balance of forces that knows whether it moves, sampled (Chen, Tan & Huang 2008).

    c = OP - MV before          the force on the stem, in units of OP
    moving along dir   while dir c > f_d:  MV = OP - dir f_d;  else it stops
    stopped            |c| > f_s:  dir = sgn(c), MV = OP - dir f_d, it moves;  else MV held

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
S    deadband plus stickband, J slip jump [unit of OP], 0 <= J <= S;  f_s = (S + J)/2, f_d = (S - J)/2
dt   sampling period [s]       low, high  ends of the span [unit of OP]; -inf and inf lift them

Source: S.-L. Chen, K. K. Tan, S. Huang, Two-layer binary tree data-driven model for valve stiction, Ind. Eng.
Chem. Res. 47 (2008) 2842-2848, written here as an equivalent balance of forces (the force as in he_valve).
At an end of the span the stem is put on its stop and stopped there.
The most robust of the sampled models here: it starts against f_s, moves against f_d, bears noise and held OP.
See also: he_valve (stops at every sample), kano_valve (the same moves on ramps).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.sampled_valve import TwoBandValve

ROUNDING = 1e-14  # of OP: an OP that stands still must not seem to rise


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    f_s, f_d = 0.5 * (p[0] + p[1]), 0.5 * (p[0] - p[1])
    op = min(max(u[0], p[2]), p[3])
    c = op - d[2]  # d: stopped, dir, MV
    if op == p[2] or op == p[3]:
        d[0] = 1.0
        d[2] = op
    else:
        if d[0] == 0.0 and d[1] * c <= f_d + ROUNDING * abs(op):
            d[0] = 1.0
        if d[0] == 1.0 and abs(c) > f_s:
            d[0] = 0.0
            d[1] = math.copysign(1.0, c)
        if d[0] == 0.0:
            d[2] = op - d[1] * f_d
    y[0] = d[2]


class ChenValve(TwoBandValve):
    """The sampled valve of Chen et al. with the bands ``S`` and ``J`` [unit of OP] and sampling period ``dt`` [s].

    ``start`` is where OP and MV stand before the first sample.  Raises ``BlockError`` unless
    0 <= J <= S <= high - low and dt > 0.

    >>> from stickslip.diagram import drive
    >>> valve = ChenValve(S=0.06, J=0.02, dt=1.0, start=0.5)
    >>> drive(valve, 4.0, every=1.0, OP=([0, 1, 2, 3, 4], [0.5, 0.53, 0.56, 0.59, 0.54])).log["MV"].round(3).tolist()
    [0.5, 0.5, 0.54, 0.57, 0.57]
    """

    kernels = Kernels(step=_step)

    @staticmethod
    def memory_at(start: float) -> Mapping[str, float]:
        """Return the memory of a valve at rest at ``start``."""
        return {"stopped": 1.0, "dir": 0.0, "MV": start}
