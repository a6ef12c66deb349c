"""Gain of the valve: the flow is ``factor`` times what the stem position should give."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, above
from stickslip.gap.insertion.inserted import Inserted


class ValveGain(Inserted):
    """A valve of another size.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ValveGain().insert(self_regulating_loop(), "valve", factor=1.2)["valve:valve_gain"].params["factor"]
    1.2
    """

    name = "valve_gain"
    role = Role.VALVE
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"),)
    where = "after"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the gain."""
        return Gain("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the gain."""
        return {f"{self.block(place)}.factor": values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
