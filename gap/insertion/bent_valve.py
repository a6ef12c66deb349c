"""Valve blocks that hold their characteristic: what they give is a flow, and their stem stands before it.

A stem sticks, lags and stops as it is wanted, so what it does comes before the law from stem to flow.  A gain and a
leak are of the flow, and come behind.  Where a valve gives its stem, or what is in proportion to it, both are the same.
Half of a split range stands at its stop where the other half moves: what it gives is its stem.
A block that has a lag and a law is asked at rest: its stem comes before both, so that it sticks by shares of OP.
What a block gives that reads a pressure beside OP is a flow.
"""

from functools import lru_cache

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.paths import command, moved_by
from stickslip.gap.insertion.scales import at_rest, ends

POINTS = 5  # at which what a valve gives is held against a straight line
STRAIGHT = 1e-3  # of its range, that it may be off


def gives_flow(diagram: Diagram, place: str) -> bool:
    """Return whether a valve reads more than OP, or without memory bends what enters it, at rest, and stands nowhere.

    >>> from stickslip.blocks import Equations, IdealValve
    >>> from stickslip.diagram import wire
    >>> law = Equations("valve", out=lambda OP: 30.0 ** (OP - 1.0), inputs="OP", outputs="f")
    >>> gives_flow(wire([law.with_role("valve", OP="OP", MV="f")], inputs=["OP"]), "valve")
    True
    >>> gives_flow(wire([IdealValve()], inputs=["OP"]), "valve")
    False
    """
    block = diagram[place]
    if block.role is not Role.VALVE or command(block) is None:
        return False
    if len(block.input_labels) > 1:
        return True
    if len(block.output_labels) > 1 or block.memory_names or block.sampled or block.kernels.n_events:
        return False
    low, high = ends(diagram, str(block.input_labels[0])) or (0.0, 1.0)
    return _bends(block, low, high)


@lru_cache(maxsize=256)
def _bends(block: Block, low: float, high: float) -> bool:
    at = np.linspace(low, high, POINTS)
    try:
        values = np.array([at_rest(block, u) if block.state_names else _given(block, u) for u in at.tolist()])
    except (ArithmeticError, ValueError):  # a user's law need not hold at the ends of a span
        return False
    line = values[0] + (values[-1] - values[0]) * (at - low) / (high - low)
    moves = bool(np.all(np.diff(values) > 0.0) or np.all(np.diff(values) < 0.0))
    return moves and bool(np.max(np.abs(values - line)) > STRAIGHT * float(np.ptp(values)))


def _given(block: Block, u: float) -> float:
    return float(block.output(0.0, [], [u])[0])


def with_stem(diagram: Diagram, place: str, stem: Block, inputs: tuple[str, ...] = ()) -> Diagram:
    """Return the diagram with a block where the stem of a valve is; of several inputs one has its signal's name.

    At any other place it is in what the place gives.
    """
    readers = place if gives_flow(diagram, place) else None
    return diagram.insert(stem_signal(diagram, place), stem, readers=readers, inputs=inputs)


def stem_signal(diagram: Diagram, place: str) -> str:
    """Return the signal at a valve, in a model without effects, that is the stem: what it gives, or what enters it."""
    block = diagram[place]
    return str(command(block)) if gives_flow(diagram, place) else moved_by(block)
