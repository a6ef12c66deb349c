"""Friction of a line: ``factor`` times the pressure loss at the same flow; the resistance K goes down with its root."""

from stickslip.blocks.block import Block
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.factor import Factor


class LineFriction(Factor):
    """A line that is rougher or partly blocked.

    >>> from stickslip.plant import production_plant
    >>> LineFriction().places(production_plant())
    ('C3_pipe', 'C2_pipe')
    """

    name = "line_friction"
    role = Role.PROCESS
    key = "K"
    power = -0.5
    parameters = (Parameter("factor", "-", 1.0, 0.2, 5.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is a line."""
        return isinstance(block, FlowResistance)
