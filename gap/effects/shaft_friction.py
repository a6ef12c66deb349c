"""Friction of a shaft: its bearings take a torque of ``coefficient`` [N m s/rad] times its speed."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.shaft import Shaft
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, not_below


class ShaftFriction(Effect):
    """A shaft whose bearings rub.

    >>> from stickslip.plant import production_plant
    >>> ShaftFriction().places(production_plant())
    ('shaft',)
    """

    name = "shaft_friction"
    role = Role.PROCESS
    parameters = (Parameter("coefficient", "N m s/rad", 0.0, 0.02, 10.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is a shaft."""
        return isinstance(block, Shaft)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the torque of friction taken off the drive's."""
        drive, speed = str(diagram[place].input_labels[0]), str(diagram[place].output_labels[0])
        return diagram.insert(drive, Sum(drive, {drive: 1.0, speed: 0.0}, name=self.block(place)), readers=place)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the coefficient as a weight of the speed."""
        return {f"{self.block(place)}.w_{diagram[place].output_labels[0]}": -values["coefficient"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"coefficient": 0.0})
