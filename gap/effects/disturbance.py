"""What the disturbances at a feed share: a wave that is added to what the feed gives.

A feed is a block of the role disturbance whose signal enters a process, directly or through sums and filters; in a
diagram that says of none that it is one, any source that does.
"""

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.added import with_added
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.paths import reaches_process


class Disturbance(Effect):
    """A wave that is added at a feed; subclasses return it from ``wave``."""

    role = Role.DISTURBANCE

    def wave(self) -> Block:
        """Return the source of the signal "wave", with any values that it may have."""
        raise NotImplementedError

    def places(self, diagram: Diagram) -> tuple[str, ...]:
        """Return the disturbances whose signal enters a process; where there is none, the sources."""
        found = [b for b in diagram.blocks if b.role.drives and ":" not in b.name and self.fits(diagram, b)]
        stated = [b.name for b in found if b.role is Role.DISTURBANCE]
        return tuple(stated or [b.name for b in found])

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether what the block gives enters a process."""
        return len(block.output_labels) == 1 and reaches_process(diagram, block)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the wave added to the signal of the feed."""
        return with_added(diagram, str(diagram[place].output_labels[0]), self.wave(), self.block(place))
