"""Characteristic: the flow is not linear in the stem position x, but (R^x - 1)/(R - 1), R = ``rangeability`` [-].

R = 1 is linear, R < 1 opens quickly (``stickslip.blocks.characteristic``).  x and the flow are shares of the full span.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.characteristic import Characteristic
from stickslip.blocks.role import Role
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, above
from stickslip.gap.insertion.inserted import Inserted, percent_out


class ValveCharacteristic(Inserted):
    """A valve whose trim is not linear.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> curved = ValveCharacteristic().insert(self_regulating_loop(), "valve", rangeability=30.0)
    >>> curved["valve:valve_characteristic/law"].params["R"]
    30.0
    """

    name = "valve_characteristic"
    role = Role.VALVE
    parameters = (Parameter("rangeability", "-", 1.0, 0.05, 100.0, "log"),)
    where = "after"

    def made(self, diagram: Diagram, place: str) -> Diagram | Block:
        """Return the law, between the factors that make shares of the span of its signals."""
        full = 100.0 * percent_out(diagram, place)
        law = Characteristic(2.0, name="law", inputs="x", outputs="share")
        return wire(
            [Gain("x", "in", 1.0 / full), law, Gain("out", "share", full)], ["in"], ["out"], name=self.block(place)
        )

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rangeability of the law."""
        return {f"{self.block(place)}/law.R": values["rangeability"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "rangeability")
