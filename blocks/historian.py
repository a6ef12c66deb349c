"""Historian: what a plant's archive makes of a signal after everyone in the loop has used it.

    PV_logged,k = step round(PV(t_k) / step)         at t_k = offset + k dt, held until t_(k+1); not rounded if step = 0

in   PV  any signal [its unit]             out  PV_logged  the same as it is archived [its unit]
dt   log interval [s], > 0     offset  first logged time [s]     step  resolution of the archive [unit of PV], >= 0

Its output is for detectors and for the log.  A controller reads the transmitter, not the archive, so nothing that acts
on the loop belongs behind it: rounding that the controller sees is that of the sensor.  Give each signal a historian
of its own, e.g. ``Historian(1.0, step=0.1, name="OP_historian", inputs="OP", outputs="OP_logged")``.

Valid for an archive that stores on a fixed interval.  Not for: swinging-door compression, which joins samples that are
far apart by lines (``logs.dirt.swinging_door`` does that to a finished log).
Source: textbook.  See also: sensor (what the loop itself reads), zero_order_hold.
"""

from collections.abc import Mapping
from typing import Any

from blocks.arithmetic import Gain
from blocks.block import Block, Kernels
from blocks.ports import Port
from blocks.role import Role
from blocks.rounding import rounded
from blocks.rules import check_scan, not_negative


def _step(PV: float, step: float) -> float:
    return rounded(PV, step)


class Historian(Block):
    """An archive that keeps a signal every ``dt`` [s] with the resolution ``step`` [unit of PV].

    ``offset``: first logged time [s].  ``start``: what is archived before it [unit of PV].
    Raises ``BlockError`` unless dt > 0 and step >= 0.

    >>> from diagram import drive
    >>> drive(Historian(2.0, step=0.5), 4.0, every=1.0, PV=([0, 4], [0.0, 2.0])).log["PV_logged"].tolist()
    [0.0, 0.0, 1.0, 1.0, 2.0]
    """

    role = Role.HISTORIAN
    ports_in = (Port("PV"),)
    ports_out = (Port("PV_logged"),)
    kernels = Kernels(step=_step)
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        dt: float,
        *,
        step: float = 0.0,
        offset: float = 0.0,
        start: float = 0.0,
        name: str = "historian",
        **labels: Any,
    ) -> None:
        params = {"dt": dt, "offset": offset, "step": step}
        super().__init__(name=name, params=params, start_output=[start], **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless dt > 0 and step >= 0."""
        check_scan(params, name)
        not_negative(params, name, "step", remedy="give the resolution, or 0 for none")

    def smooth(self) -> Block:
        """Return the signal itself, which python-control sees in place of its samples."""
        source, signal, unit = self.input_labels[0], self.output_labels[0], self.units["PV_logged"]
        return Gain(signal, source, 1.0, unit=unit, name=self.name)
