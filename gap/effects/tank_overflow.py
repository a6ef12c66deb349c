"""Overflow of a tank: it runs over at ``level`` [unit of its level], and a ``share`` [-] of that reaches the next tank.

The next tank is the one that reads the outflow.  Of a last tank what runs over is lost, whatever the share.
"""

import math
from collections.abc import Mapping
from typing import Any

from blocks.arithmetic import Sum
from blocks.block import Block
from blocks.role import Role
from blocks.tank import Tank
from diagram.diagram import Diagram
from gap.insertion.effect import Effect, Parameter
from gap.insertion.paths import users


class TankOverflow(Effect):
    """A tank that runs over.

    >>> from diagram import wire
    >>> tanks = wire([
    ...     Tank(name="tank_1", outputs=["h_1", "q_1", "o_1"]),
    ...     Tank(name="tank_2", inputs="q_1", outputs=["h_2", "q_2", "o_2"]),
    ... ], inputs=["q_in"])
    >>> TankOverflow().insert(tanks, "tank_1", level=10.0, share=0.5)["tank_1:tank_overflow"].params["w_o_1"]
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
        _, outflow, over = map(str, diagram[place].output_labels)
        below = [name for name in users(diagram, outflow) if diagram[name].role is Role.PROCESS]
        if not below:
            return diagram
        return diagram.insert(outflow, Sum(outflow, {outflow: 1.0, over: 0.0}, name=self.block(place)), readers=below)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rim of the tank, and the share as a weight."""
        _, outflow, over = map(str, diagram[place].output_labels)
        share = {f"{self.block(place)}.w_{over}": values["share"]} if users(diagram, outflow) else {}
        return {f"{place}.top": values["level"], **share}

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
