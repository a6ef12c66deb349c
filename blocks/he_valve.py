"""Sticky valve as a balance of spring and friction, sampled (He, Wang, Pottmann & Qin 2007).

    c = OP - MV before          the force on the stem, in units of OP
    |c| > f_s   MV = OP - sgn(c) f_d
    else        MV held

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
f_s, f_d  static and kinetic friction bands [unit of OP], f_s >= f_d >= 0;  S = f_s + f_d, J = f_s - f_d
dt   sampling period [s]       low, high  ends of the span [unit of OP]; -inf and inf lift them

Source: Q. P. He, J. Wang, M. Pottmann, S. J. Qin, A curve fitting method for detecting valve stiction in
oscillating control loops, Ind. Eng. Chem. Res. 46 (2007) 4549-4560.
The paper sums the force up, c = u_r + OP - OP before with u_r what the friction held back at the last sample;
from a start at OP = MV that is OP - MV before, written here without the rounding of a running sum.
At an end of the span the stem is put on its stop.
The stem sticks again at every sample, so it follows a slow ramp in steps of J and more; in a limit cycle, which
breaks away once per half cycle, that hardly matters.  f_s = f_d is a play of width 2 f_s.
See also: chen_valve (keeps moving against f_d only), kano_valve.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Kernels
from stickslip.blocks.ports import require
from stickslip.blocks.sampled_valve import SampledValve, check_sampling


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    op = min(max(u[0], p[2]), p[3])
    c = op - d[0]
    if op == p[2] or op == p[3]:
        d[0] = op
    elif abs(c) > p[0]:
        d[0] = op - math.copysign(p[1], c)
    y[0] = d[0]


class HeValve(SampledValve):
    """The sampled valve of He et al. with friction bands ``f_s`` >= ``f_d`` [unit of OP] and period ``dt`` [s].

    ``start`` is where OP and MV stand before the first sample.  Raises ``BlockError`` unless f_s >= f_d >= 0,
    f_s + f_d <= high - low and dt > 0.

    >>> from stickslip.diagram import drive
    >>> valve = HeValve(f_s=0.04, f_d=0.02, dt=1.0, start=0.5)
    >>> drive(valve, 4.0, every=1.0, OP=([0, 1, 2, 3, 4], [0.5, 0.53, 0.56, 0.59, 0.54])).log["MV"].round(3).tolist()
    [0.5, 0.5, 0.54, 0.57, 0.57]
    """

    kernels = Kernels(step=_step)

    def __init__(
        self, f_s: float, f_d: float, dt: float, *, low: float = 0.0, high: float = 1.0, start: float = 0.0,
        name: str = "valve", **labels: Any,
    ) -> None:  # fmt: skip
        super().__init__(
            name=name,
            params={"f_s": f_s, "f_d": f_d, "low": low, "high": high, "dt": dt},
            memory={"MV": start},
            start_output=start,
            **labels,
        )

    @classmethod
    def from_bands(cls, S: float, J: float, dt: float, **keywords: Any) -> Self:
        """Return the valve with f_s = (S + J)/2 and f_d = (S - J)/2 [unit of OP]."""
        return cls((S + J) / 2.0, (S - J) / 2.0, dt, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless f_s >= f_d >= 0, f_s + f_d <= high - low and dt > 0."""
        check_sampling(params, name)
        f_s, f_d = float(params["f_s"]), float(params["f_d"])
        span = float(params["high"]) - float(params["low"])
        require(f_d >= 0.0, name, "f_d", f_d, "a friction band is not negative", "give 0 or more")
        rule = f"static friction is at least the kinetic one, f_s >= f_d = {f_d}"
        require(f_d <= f_s < math.inf, name, "f_s", f_s, rule, "raise f_s or lower f_d")
        rule = f"f_s + f_d = {f_s + f_d} must fit into the span of OP, {span}"
        require(f_s + f_d <= span, name, "f_s", f_s, rule, "with OP in percent give high=100")
