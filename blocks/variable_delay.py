"""Dead time that varies while it runs: a belt or a pipe whose speed changes, computed at scan times.

    y_k = u(t_k - theta_k),   0 <= theta_k <= longest,   t_k = k dt;   straight lines between the samples of u

in   in     any signal, named second            theta  dead time now [s], named third; kept within 0 ... longest
out  out    the signal of theta seconds ago, held until the next scan, named first
dt          scan time [s], > 0                  longest  the longest dead time [s], >= dt; longest/dt samples are kept
start       in before the start [unit of in]

theta_k says how old the value is that arrives now.  For plug flow of volume V it is the time in which V has flowed
since, not V divided by the present flow; the two agree where the flow changes slowly.  Between scans y is held, which
adds dt/2 on average.  Slopes are those of a wire, y = u.  A constant dead time is exact in dead_time.
Valid for any signal; what changes within dt is not seen.  Source: textbook.
See also: dead_time, first_order (theta=), zero_order_hold.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive

MOST = 10_000  # samples that are kept

# p = dt, longest;   d = samples taken, then a ring of the last ones


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    size = math.ceil(p[1] / p[0]) + 2
    taken = int(d[0])
    d[1 + taken % size] = u[0]
    theta = u[1] if u[1] > 0.0 else 0.0  # also what is no number
    back = min(theta, p[1]) / p[0]
    whole = int(back)
    newer = d[1 + (taken - whole) % size]
    older = d[1 + (taken - whole - 1) % size]
    y[0] = newer + (back - whole) * (older - newer)
    d[0] = taken + 1.0


class VariableDelay(Block):
    """``source`` of ``theta`` seconds ago, taken every ``dt`` [s]; theta is a signal.

    Raises ``BlockError`` unless dt > 0 and dt <= longest <= 10 000 dt.

    >>> from stickslip.diagram import drive
    >>> late = VariableDelay("y", "u", "age", dt=0.5, longest=10.0)
    >>> drive(late, 4.0, every=1.0, u=([0.0, 4.0], [0.0, 4.0]), age=([0.0, 4.0], [0.0, 2.0])).log["y"].tolist()
    [0.0, 0.5, 1.0, 1.5, 2.0]
    """

    role = Role.PROCESS
    ports_in = (Port("in"), Port("theta", "s"))
    ports_out = (Port("out"),)
    kernels = Kernels(step=_step)
    period_param = "dt"

    def __init__(
        self,
        signal: str,
        source: str,
        theta: str,
        *,
        dt: float,
        longest: float,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        self.check({"dt": dt, "longest": longest}, name or signal)
        kept = math.ceil(longest / dt) + 2
        super().__init__(
            name=name or signal,
            params={"dt": dt, "longest": longest},
            memory={"taken": 0.0} | {f"u_{i}": start for i in range(kept)},
            start_output=[start],
            inputs=[source, theta],
            outputs=signal,
            units={"in": unit, "out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless dt > 0 and dt <= longest <= 10 000 dt."""
        positive(params, name, "dt", "longest", remedy="give seconds")
        dt, longest = float(params["dt"]), float(params["longest"])
        rule = f"from one to {MOST} scans of {dt} s are kept"
        require(dt <= longest <= MOST * dt, name, "longest", longest, rule, "change longest or dt")

    def with_params(self, **changes: float) -> Self:
        """Return a copy; raise ``BlockError`` for an unknown name, or for times that keep another number of samples."""
        other = super().with_params(**changes)
        if math.ceil(other.p[1] / other.p[0]) != math.ceil(self.p[1] / self.p[0]):
            raise BlockError(
                f"{self.name}: longest/dt = {other.p[1] / other.p[0]:.6g}, but there is room for "
                f"{math.ceil(self.p[1] / self.p[0])} samples; make another VariableDelay"
            )
        return other

    def smooth(self) -> Block:
        """Return the wire of which slopes are taken."""
        source, theta = self.input_labels
        return Sum(self.output_labels[0], {source: 1.0, theta: 0.0}, unit=self.units["out"], name=self.name)
