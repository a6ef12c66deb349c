"""A dead time as scan values: what a filter can spread, which it cannot do with the records of a delay.

    y_k = (1 - w) u_(k-j) + w u_(k-j-1),   theta = (j + w) dt + held/2,   0 <= w < 1

theta is a parameter, or one plus a signal where the dead time varies.

Between scans y is held; a held input is delayed exactly by multiples of dt.  Where the scans of the record are finer
than dt, y is ``held`` [s] longer than they are, which delays it by half of that in the mean.
"""

import math
from typing import Any, Self

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Labels, Port
from stickslip.blocks.role import Role
from stickslip.blocks.variable_delay import VariableDelay


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = int(p[2])
    theta = p[0] + (u[1] if p[4] > 0.0 and u[1] > 0.0 else 0.0)
    back = min(max((theta - 0.5 * p[3]) / p[1], 0.0), n - 1.0)
    j = math.floor(back)
    w = back - j
    for i in range(n - 1, 0, -1):
        d[i] = d[i - 1]
    d[0] = u[0]
    y[0] = (1.0 - w) * d[j] + (w * d[j + 1] if w > 0.0 else 0.0)


class Late(Block):
    """What enters arrives later by ``theta`` [s], in scans of ``dt`` [s], at most ``longest`` [s].

    >>> from stickslip.diagram import drive
    >>> drive(Late(2.0, dt=1.0, longest=4.0), 3.0, every=1.0, **{"in": 1.0}).log["out"].tolist()
    [0.0, 0.0, 1.0, 1.0]
    """

    role = Role.PROCESS
    ports_in: tuple[Port, ...] = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(step=_step)
    period_param = "dt"

    def __init__(
        self, theta: float, *, dt: float, longest: float, held: float = 0.0, start: float = 0.0, name: str = "late",
        inputs: Labels = None, outputs: Labels = None,
    ) -> None:  # fmt: skip
        scans = math.ceil(longest / dt - 1e-9) + 2
        super().__init__(
            name=name,
            params={
                "theta": theta, "dt": dt, "scans": float(scans), "held": held, "signals": len(self.ports_in) - 1.0
            },
            memory={f"u_{i}": start for i in range(scans)}, start_output=[start], inputs=inputs, outputs=outputs,
        )  # fmt: skip


class LateByASignal(Late):
    """The same where a second input says how much later it arrives than ``theta`` [s].

    >>> from stickslip.diagram import drive
    >>> late = LateByASignal(0.0, dt=1.0, longest=4.0)
    >>> drive(late, 3.0, every=1.0, **{"in": 1.0, "theta": 2.0}).log["out"].tolist()
    [0.0, 0.0, 1.0, 1.0]
    """

    ports_in = (Port("in"), Port("theta", "s"))

    @classmethod
    def of(cls, block: VariableDelay, scan: float, values: int) -> Self:
        """Return what stands for a dead time that varies, whose own values turn round and have no slopes.

        It has so many ``values`` at most, in multiples of a ``scan`` [s].
        """
        longest = block.params["longest"]
        dt = scan * max(1, math.ceil(longest / scan / values))
        return cls(
            0.0, dt=dt, longest=longest, held=dt - scan, start=float(block.y0[0]), name=block.name,
            inputs=list(block.input_labels), outputs=list(block.output_labels),
        )  # fmt: skip
