"""A wave that is added to a signal: a disturbance, a pulse that shows a response, a random signal."""

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram


def with_added(diagram: Diagram, signal: str, wave: Block, name: str) -> Diagram:
    """Return a diagram in which everybody who reads a signal reads it with a ``wave`` added, the block "wave".

    >>> from stickslip.blocks import Constant, FirstOrder, Step
    >>> load = wire([Constant("load", 1.0), FirstOrder(1.0, 9.0, inputs="load")])
    >>> with_added(load, "load", Step("wave", 2.0), "load:step")["load:step/wave"].output_labels
    ['load:step/wave']
    """
    added = [wave, Sum("out", {"in": 1.0, "wave": 1.0}, name="sum")]
    return diagram.insert(signal, wire(added, ["in"], ["out"], name=name))
