"""A filter of second order that a control system computes at scan times: low pass, notch, lead.

    y_k = b_0 u_k + b_1 u_(k-1) + b_2 u_(k-2) - a_1 y_(k-1) - a_2 y_(k-2)
    low pass   G(s) = omega^2/(s^2 + 2 zeta omega s + omega^2), by the bilinear transform, in which the edge omega is
               kept:  s -> omega/tan(omega dt/2) (z - 1)/(z + 1)

in   in  any signal, named second          out  out  the filtered signal, held between samples, named first
dt   scan time [s], > 0     offset  first scan [s]
b_0, b_1, b_2, a_1, a_2  coefficients [-]; stable if |a_2| < 1 and |a_1| < 1 + a_2
start    input at which it starts settled [unit of in]

Computed in the transposed direct form II.  Slopes are its gain for slow signals.
Valid for any dt; the edge omega of a low pass must lie below pi/dt.
Source: Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed. 2010, sections 6.3 and 7.2.
See also: sampled_filter (first order), zero_order_hold.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, finite


def _biquad_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * u[0] + d[0]
    d[0] = p[1] * u[0] - p[3] * y[0] + d[1]
    d[1] = p[2] * u[0] - p[4] * y[0]


class Biquad(OneToOne):
    """A filter of second order with the coefficients ``b`` = (b_0, b_1, b_2) and ``a`` = (a_1, a_2), every ``dt`` [s].

    ``Biquad.low_pass`` designs one.  Raises ``BlockError`` unless it is stable and dt > 0.

    >>> smooth = Biquad.low_pass("PV_f", "PV", omega=0.5, dt=1.0)
    >>> smooth.p[:5].round(4).tolist()
    [0.0457, 0.0914, 0.0457, -1.3108, 0.4936]
    """

    role = Role.FILTER
    kernels = Kernels(step=_biquad_step)
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self, signal: str, source: str, b: Sequence[float], a: Sequence[float], dt: float, *, offset: float = 0.0,
        start: float = 0.0, unit: str = "", name: str = "",
    ) -> None:  # fmt: skip
        name = name or signal
        require(len(b) == 3, name, "b", list(b), "there are three, b_0, b_1 and b_2", "fill up with 0")
        require(len(a) == 2, name, "a", list(a), "there are two, a_1 and a_2, a_0 being 1", "divide by a_0")
        params = {f"b_{i}": value for i, value in enumerate(b)} | {"a_1": a[0], "a_2": a[1], "dt": dt, "offset": offset}
        self.check(params, name)
        settled = sum(b) / (1.0 + sum(a)) * start
        second = b[2] * start - a[1] * settled
        super().__init__(
            signal,
            source,
            params,
            memory={"s_1": b[1] * start - a[0] * settled + second, "s_2": second},
            start_output=[settled],
            unit=unit,
            name=name,
        )

    @classmethod
    def low_pass(
        cls, signal: str, source: str, omega: float, dt: float, *, zeta: float = math.sqrt(0.5), **keywords: Any
    ) -> Self:
        """Return the low pass with edge ``omega`` [rad/s] and damping ``zeta`` [-].

        Raises ``BlockError`` unless 0 < omega < pi/dt and zeta > 0.
        """
        name = str(keywords.get("name", signal))
        require(zeta > 0.0, name, "zeta", zeta, "a damping is positive", "give 0.7 or so")
        rule = f"the edge of a low pass lies between 0 and pi/dt = {math.pi / dt:.6g} rad/s"
        require(0.0 < omega < math.pi / dt, name, "omega", omega, rule, "scan faster or lower it")
        c = 1.0 / math.tan(0.5 * omega * dt)
        whole = c * c + 2.0 * zeta * c + 1.0
        b = (1.0 / whole, 2.0 / whole, 1.0 / whole)
        a = (2.0 * (1.0 - c * c) / whole, (c * c - 2.0 * zeta * c + 1.0) / whole)
        return cls(signal, source, b, a, dt, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless the filter is stable and dt > 0."""
        finite(params, name, "b_0", "b_1", "b_2", "a_1", "a_2")
        check_scan(params, name)
        a_1, a_2 = float(params["a_1"]), float(params["a_2"])
        remedy = "mind the signs: y_k = ... - a_1 y_(k-1) - a_2 y_(k-2)"
        require(abs(a_2) < 1.0, name, "a_2", a_2, "a stable filter has |a_2| < 1", remedy)
        require(
            abs(a_1) < 1.0 + a_2, name, "a_1", a_1, f"a stable filter has |a_1| < 1 + a_2 = {1.0 + a_2:.6g}", remedy
        )

    def smooth(self) -> Block:
        """Return the gain for slow signals, of which slopes are taken."""
        gain = float(sum(self.p[:3]) / (1.0 + self.p[3] + self.p[4]))
        return Gain(self.output_labels[0], self.input_labels[0], gain, unit=self.units["out"], name=self.name)
