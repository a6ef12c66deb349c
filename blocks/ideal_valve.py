"""A valve without friction: the stem is where the controller wants it.

    MV = OP

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]

What slopes are taken of in place of a sampled valve model, and the valve to replace a sticky one by when the rest of
the loop is in question.
See also: stick_slip, quasi_static_stem, kano_valve, choudhury_valve, he_valve, chen_valve, stenman_valve.
"""

from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0]


class IdealValve(Block):
    """A valve whose stem follows the controller output exactly.

    >>> float(IdealValve().output(0.0, [], [0.3])[0])
    0.3
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = Kernels(out=_out, linear=True)

    def __init__(self, *, name: str = "valve", **labels: Any) -> None:
        super().__init__(name=name, params={}, **labels)

    @classmethod
    def instead_of(cls, valve: Block) -> "IdealValve":
        """Return the ideal valve that takes the place of another one: same name, labels and units."""
        return cls(
            name=valve.name,
            inputs=list(valve.input_labels),
            outputs=list(valve.output_labels),
            units=valve.units,
            spans=valve.spans,
        )
