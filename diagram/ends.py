"""The blocks of a diagram as they stand where a run ended."""

from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.flatten import Ends
from stickslip.diagram.past import Past


def troubles(diagram: Diagram, ends: Ends) -> str:
    """Return what the blocks of a failed run say of where it ended, "" if none of them knows."""
    return "; ".join(filter(None, (block.trouble() for block in at_end(diagram, ends).blocks)))


def at_end(diagram: Diagram, ends: Ends) -> Diagram:
    """Return the diagram with states, memories, held outputs and dead times as they stand at the end of a run."""
    blocks: list[Block] = list(diagram.blocks)
    first = {signal: i for i, signal in enumerate(diagram.signals)}
    for end in ends:
        for b in end.component.blocks:
            if b < len(blocks) and (len(blocks[b].x0) or len(blocks[b].d0)):
                values = dict(zip(blocks[b].state_names, end.states(b, len(blocks[b].x0)), strict=True))
                values |= dict(zip(blocks[b].memory_names, end.memory(b, len(blocks[b].d0)), strict=True))
                blocks[b] = blocks[b].starting_at(**{k: float(v) for k, v in values.items()})
            if b < len(blocks) and blocks[b].sampled:
                held = end.outputs(first[blocks[b].output_labels[0]], len(blocks[b].y0))
                blocks[b] = blocks[b].holding(held)
    return diagram.with_blocks(blocks).with_past(Past.of(diagram.blocks, diagram.plan_in_cells().delays, ends))
