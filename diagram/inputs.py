"""Close the open inputs of a diagram with signals."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from blocks.block import Block
from blocks.ports import nearest
from blocks.recorded import Recorded
from blocks.sources import Constant
from diagram.diagram import Diagram
from diagram.wiring import WiringError


def source(signal: str, given: Any) -> Block:
    """Return a source of ``signal``: from a number, a pair of arrays ``(t, values)``, or a source block.

    Raises ``WiringError`` for anything else.
    """
    if isinstance(given, Block):
        if given.ports_in or len(given.ports_out) != 1:
            raise WiringError(f"block '{given.name}' cannot drive input '{signal}': it must be a source of one signal")
        return given.relabelled(signal, [], [signal])
    if isinstance(given, tuple) and len(given) == 2:
        return Recorded(signal, *given)
    if np.ndim(given) == 0 and isinstance(given, int | float | np.floating | np.integer):
        return Constant(signal, float(given))
    raise WiringError(
        f"input '{signal}' was given {type(given).__name__}; give a number, a pair (t, values), or a source block"
    )


def close(diagram: Diagram, inputs: Mapping[str, Any]) -> Diagram:
    """Return the diagram with the named inputs driven.

    Raises ``WiringError`` for an input that is not open, or as ``source`` does.
    """
    for signal in inputs:
        if signal not in diagram.open_inputs:
            raise WiringError(f"the diagram has no open input '{signal}'; {nearest(signal, list(diagram.open_inputs))}")
    sources = [source(signal, given) for signal, given in inputs.items()]
    still_open = [s for s in diagram.open_inputs if s not in inputs]
    closed = Diagram([*sources, *diagram.blocks], still_open, diagram.declared_outputs, diagram.name)
    return closed.with_past(diagram.past)
