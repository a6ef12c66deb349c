"""Friction of a line: ``factor`` times the pressure loss at the same flow; the resistance K goes down with its root."""

from blocks.block import Block
from blocks.flow_resistance import FlowResistance
from blocks.role import Role
from diagram.diagram import Diagram
from gap.insertion.effect import Parameter
from gap.insertion.factor import Factor


class LineFriction(Factor):
    """A line that is rougher or partly blocked.

    >>> from plant import production_plant
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
