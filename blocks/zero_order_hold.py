"""Zero-order hold: a signal taken every dt and held in between.

    y(t) = u(t_k)   for t_k <= t < t_(k+1),   t_k = offset + k dt

in   in  any signal, named second          out  out  the samples, held, named first
dt   sampling period [s], > 0              offset  first sample [s]        start  y before it [unit of the signal]

For a loop it is about dt/2 of dead time.  Slopes are those of a wire, y = u.
Valid for any signal; there is no filter against aliases.  Source: textbook, for example Astrom and Wittenmark,
Computer-Controlled Systems, 3rd ed. 1997, section 2.3.
See also: sampled_filter, sensor (SampledSensor: noise and quantisation too).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0]


class ZeroOrderHold(OneToOne):
    """``source``, sampled every ``dt`` [s] and held.

    Raises ``BlockError`` unless dt > 0.

    >>> from stickslip.diagram import drive
    >>> held = ZeroOrderHold("u_k", "u", dt=1.0)
    >>> drive(held, 2.0, every=0.5, u=([0.0, 2.0], [0.0, 4.0])).log["u_k"].tolist()
    [0.0, 0.0, 2.0, 2.0, 4.0]
    """

    role = Role.FILTER
    kernels = Kernels(step=_step)
    period_param = "dt"
    offset_param = "offset"
    same_unit = True

    def __init__(
        self, signal: str, source: str, dt: float, *, offset: float = 0.0, start: float = 0.0, unit: str = "",
        name: str = "",
    ) -> None:  # fmt: skip
        super().__init__(signal, source, {"dt": dt, "offset": offset}, start_output=[start], unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless dt > 0 and the offset is finite."""
        check_scan(params, name)

    def smooth(self) -> Block:
        """Return the wire of which slopes are taken."""
        return Gain(self.output_labels[0], self.input_labels[0], 1.0, unit=self.units["out"], name=self.name)
