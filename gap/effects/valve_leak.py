"""Leak: ``flow`` [% of full flow] passes whatever the stem does, an offset of the flow."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.recycle_leak import RecycleLeak
from stickslip.gap.insertion.effect import Parameter, not_below
from stickslip.gap.insertion.inserted import Inserted, known_travel, percent_out
from stickslip.gap.insertion.paths import given, users


class ValveLeak(Inserted):
    """A valve that does not shut.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ValveLeak().insert(self_regulating_loop(), "valve", flow=2.0)["valve:valve_leak"].params["offset"]
    0.02
    """

    name = "valve_leak"
    role = Role.VALVE
    parameters = (Parameter("flow", "% of full flow", 0.0, 0.05, 20.0, "log"),)
    where = "after"

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether something flows behind the stem, other than what ``recycle_leak`` is for."""
        if not super().fits(diagram, block) or not known_travel(diagram, block):
            return False
        readers = users(diagram, given(diagram, block.name))
        return not any(RecycleLeak().fits(diagram, diagram[name]) for name in readers)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the offset."""
        return Gain("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the offset in units of the flow."""
        return {f"{self.block(place)}.offset": values["flow"] * percent_out(diagram, place)}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"flow": 0.0})
