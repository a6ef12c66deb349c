"""Leak of a recycle valve: ``flow`` [% of full flow] goes back to the suction whatever its stem does."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.anti_surge import AntiSurge
from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, not_below
from stickslip.gap.insertion.paths import made_of


class RecycleLeak(Effect):
    """A recycle valve that does not shut.

    >>> from stickslip.plant import production_plant
    >>> RecycleLeak().places(production_plant())
    ('VRVC3_body', 'VRVC2_body')
    """

    name = "recycle_leak"
    role = Role.PROCESS
    parameters = (Parameter("flow", "% of full flow", 0.0, 0.1, 30.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is the body of a valve that an anti-surge controller moves."""
        stem = block.loop_signal("MV")
        if stem is None or stem not in block.input_labels:
            return False
        made = made_of(diagram, stem)
        return any(isinstance(diagram.blocks[diagram.driven[s][0]], AntiSurge) for s in made if s in diagram.driven)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with an offset of what the body reads as its stem."""
        stem = str(diagram[place].loop_signal("MV"))
        return diagram.insert(stem, Gain("out", "in", 1.0, name=self.block(place)), readers=place)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the offset [share of full flow]."""
        return {f"{self.block(place)}.offset": values["flow"] / 100.0}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"flow": 0.0})
