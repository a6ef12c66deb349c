"""Overflow of a tank: it runs over at ``level`` [unit of its level], and a ``share`` [-] of that reaches the next tank.

The next tank is the one that reads the outflow.  Of a last tank what runs over is lost, whatever the share.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.blocks.overflow import Overflow
from stickslip.blocks.role import Role
from stickslip.blocks.tank import Tank
from stickslip.diagram.composition import wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter
from stickslip.gap.insertion.paths import users


class TankOverflow(Effect):
    """A tank that runs over.

    >>> from stickslip.diagram import wire
    >>> tanks = wire([
    ...     Tank(name="tank_1", outputs=["h_1", "q_1"]),
    ...     Tank(name="tank_2", inputs="q_1", outputs=["h_2", "q_2"]),
    ... ], inputs=["q_in"])
    >>> TankOverflow().insert(tanks, "tank_1", level=10.0, share=0.5)["tank_1:tank_overflow/caught"].params["w_q_over"]
    0.5
    """

    name = "tank_overflow"
    role = Role.PROCESS
    parameters = (Parameter("level", "V", math.inf, 0.3, 1.5, per="span"), Parameter("share", "-", 0.0, 0.0, 1.0))

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is a tank."""
        return isinstance(block, Tank)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with what runs over added to what the next tank gets."""
        tank, below = diagram[place], self._below(diagram, place)
        if not below:
            return diagram
        inflow, (level, outflow) = str(tank.input_labels[0]), map(str, tank.output_labels)
        over = Overflow(name="over", inputs=[inflow, outflow, level])
        caught = Sum("q_caught", {outflow: 1.0, "q_over": 0.0}, name="caught")
        into = wire([over, caught], inputs=[inflow, outflow, level], outputs=["q_caught"], name=self.block(place))
        return diagram.insert(outflow, into, readers=below)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rim of the tank, and the share as a weight."""
        rim, into = {f"{place}.top": values["level"]}, self.block(place)
        if self._below(diagram, place):
            rim |= {f"{into}/over.top": values["level"], f"{into}/caught.w_q_over": values["share"]}
        return rim

    def _below(self, diagram: Diagram, place: str) -> list[str]:
        """Return the tanks that the outflow runs into."""
        return [
            name for name in users(diagram, str(diagram[place].output_labels[1])) if diagram[name].role is Role.PROCESS
        ]

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the tank has no rim."""
        return values["level"] == math.inf

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if not values["level"] > 0.0:
            return f"level = {values['level']:g}, but a rim lies above the bottom; leave it out for none"
        if not 0.0 <= values["share"] <= 1.0:
            return f"share = {values['share']:g}, but it is a share, from 0 to 1; correct it"
        return ""
