"""Drive one block alone: three lines to see what it does."""

from typing import Any

from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.settings import Settings
from stickslip.diagram.simulation import Run, simulate


def drive(
    block: Block,
    duration: float,
    *,
    every: float | None = None,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    method: str = "auto",
    max_step: float | None = None,
    **inputs: Any,
) -> Run:
    """Simulate one block on given input signals, named by their labels; see ``simulate`` for what they may be.

    >>> from stickslip.blocks import FirstOrder
    >>> from stickslip.diagram import drive
    >>> drive(FirstOrder(K=2.0, tau=5.0), 5.0, every=5.0, MV=1.0).log["PV"].round(4).tolist()
    [0.0, 1.2642]
    """
    if not isinstance(block, Block):
        raise ValueError(f"{block!r:.60} is no block; drive() runs one block alone, simulate(diagram, ...) a diagram")
    diagram = Diagram([block], list(block.input_labels), name=block.name)
    how = Settings(rtol, atol, method, max_step=max_step)
    return simulate(diagram, duration, every=every, inputs=inputs, settings=how)
