"""The point of linearisation of a diagram's blocks: usual values of all signals."""

from collections.abc import Mapping, Sequence

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram

ONLOOKERS = (Role.HISTORIAN, Role.DETECTOR)


def operating(
    diagram: Diagram, seen: Mapping[str, float], inputs: Sequence[str], controllers: Sequence[str]
) -> dict[str, float]:
    """Return the values of all signals at the point of linearisation: logged ones as seen, others as they follow.

    The errors of ``controllers`` are 0 there.
    """
    blocks = [b for b in diagram.blocks if b.role not in ONLOOKERS]
    found = {str(s): 0.0 for b in blocks for s in b.output_labels} | dict.fromkeys(inputs, 0.0) | dict(seen)
    for _ in range(len(blocks)):
        before = dict(found)
        for b in blocks:
            u = np.array([found.get(str(s), 0.0) for s in b.input_labels])
            out = np.asarray(b.output(0.0, b.seen_start(), u), dtype=float)
            found |= {str(s): float(y) for s, y in zip(b.output_labels, out, strict=True) if str(s) not in seen}
        if before == found:
            break
    for name in controllers:
        sp, pv = (str(diagram[name].loop_signal(part)) for part in ("SP", "PV"))
        found[pv] = found[sp]
    return found


def inside(block: Block, near: Mapping[str, float]) -> Block:
    """Return a block with the memory that gives its usual outputs: a log may begin as if it were at a limit."""
    u, y = (np.array([near[str(s)] for s in labels]) for labels in (block.input_labels, block.output_labels))
    return block.settled(u, y)
