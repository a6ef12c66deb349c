"""How python-control sees a diagram: which input of which block is fed by what, as matrices, and its parameters."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from blocks.ports import nearest
from diagram.wiring import WiringError

if TYPE_CHECKING:
    from diagram.diagram import Diagram

Floats = NDArray[np.float64]


def connection_maps(diagram: "Diagram") -> tuple[Floats, Floats, Floats]:
    """Return python-control's three maps of a diagram, with all ports of all blocks in the order of the blocks.

    From blocks' outputs to blocks' inputs (inputs, outputs); from open inputs to blocks' inputs (inputs, open inputs);
    from blocks' outputs and inputs to the outputs of the diagram (outputs of the diagram, outputs + inputs).
    """
    columns = {signal: diagram.output_offset[b] + j for signal, (b, j) in diagram.driven.items()}
    n_in, n_out = (sum(len(b.ports_in) for b in diagram.blocks), sum(len(b.ports_out) for b in diagram.blocks))
    connections, entries = np.zeros((n_in, n_out)), np.zeros((n_in, len(diagram.open_inputs)))
    for row, signal in enumerate(signal for block in diagram.blocks for signal in block.input_labels):
        if signal in columns:
            connections[row, columns[signal]] = 1.0
        else:
            entries[row, diagram.open_inputs.index(signal)] = 1.0
    exits = np.zeros((len(diagram.chosen_outputs), n_out + n_in))
    for i, signal in enumerate(diagram.chosen_outputs):
        exits[i, columns[signal]] = 1.0
    return connections, entries, exits


def own_params(diagram: "Diagram", given: Mapping[str, float]) -> dict[str, float]:
    """Return the diagram's own of the parameters that python-control hands over.

    In an interconnection there are those of other systems among them; alone, an unknown one is refused.
    """
    joined = diagram.params.keys() <= given.keys()
    for key in given.keys() - diagram.params.keys():
        if not joined or any(key.startswith(f"{block.name}.") for block in diagram.blocks):
            raise WiringError(f"the diagram has no parameter '{key}'; {nearest(key, list(diagram.params))}")
    return {key: value for key, value in given.items() if key in diagram.params}
