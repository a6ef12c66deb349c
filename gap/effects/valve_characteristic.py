"""Characteristic: the flow is not linear in the stem position x, but F (R^x - 1)/(R - 1).

    R  ``rangeability`` [-]; 1 is linear, below 1 the valve opens quickly (``stickslip.blocks.characteristic``)
    F  ``flow`` of the open valve over that of the model [-]

x and the flow are shares of the full span.  F is 1 where it is not given.  A model that was fitted at one opening has
the right flow there, and another F; that costs a fit one more value.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.characteristic import Characteristic
from stickslip.blocks.role import Role
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import NOMINAL, Parameter, above
from stickslip.gap.insertion.inserted import Inserted, known_travel, percent_out


def flow_at(x: float, R: float) -> float:
    """Return the flow at an opening ``x`` over that of the open valve.

    >>> flow_at(0.5, 1.0), round(flow_at(0.5, 9.0), 3)
    (0.5, 0.25)
    """
    return x if R == 1.0 else math.expm1(x * math.log(R)) / (R - 1.0)


class ValveCharacteristic(Inserted):
    """A valve whose trim is not linear.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> curved = ValveCharacteristic().insert(self_regulating_loop(), "valve", rangeability=30.0)
    >>> curved["valve:valve_characteristic/law"].params["R"]
    30.0
    """

    name = "valve_characteristic"
    role = Role.VALVE
    parameters = (
        Parameter("rangeability", "-", 1.0, 0.05, 100.0, "log"), Parameter("flow", "-", NOMINAL, 0.1, 10.0, "log"),
    )  # fmt: skip
    where = "after"
    level = "flow"

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the full flow is known, of which the law makes shares."""
        return super().fits(diagram, block) and known_travel(diagram, block)

    def made(self, diagram: Diagram, place: str) -> Diagram | Block:
        """Return the law, between the factors that make shares of the span of its signals."""
        full = 100.0 * percent_out(diagram, place)
        law = Characteristic(2.0, name="law", inputs="x", outputs="share")
        return wire(
            [Gain("x", "in", 1.0 / full), law, Gain("out", "share", full)], ["in"], ["out"], name=self.block(place)
        )

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rangeability of the law, and the flow that a full span stands for."""
        full = 100.0 * percent_out(diagram, place)
        block, flow = self.block(place), np.nan_to_num(values.get("flow", NOMINAL), nan=1.0)
        return {f"{block}/law.R": values["rangeability"], f"{block}/out.factor": flow * full}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the valve is linear, and of the size that the model has."""
        return values["rangeability"] == 1.0 and bool(np.nan_to_num(values["flow"], nan=1.0) == 1.0)

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        given = [name for name in ("rangeability", "flow") if not math.isnan(values[name])]
        return above(values, *given)
