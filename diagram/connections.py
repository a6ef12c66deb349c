"""How python-control sees a diagram: connection maps, made when it first looks at them, and its parameters.

The maps are full matrices of as many rows and columns as there are ports, for which a large diagram has no use.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.ports import nearest
from stickslip.diagram.wiring import WiringError


class ConnectionMap:
    """An attribute of a diagram: the map as it was set, or else what the wiring says."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, diagram: Any, owner: type) -> Any:
        if diagram is None:
            return self
        if self.name not in diagram.__dict__:
            diagram.__dict__ |= connection_maps(diagram)
        return diagram.__dict__[self.name]

    def __set__(self, diagram: Any, value: NDArray[np.float64]) -> None:
        diagram.__dict__[self.name] = value


def connection_maps(diagram: Any) -> dict[str, NDArray[np.float64]]:
    """Return ``connect_map``, ``input_map`` and ``output_map`` as python-control defines them."""
    columns = {signal: diagram.output_offset[b] + j for signal, (b, j) in diagram.driven.items()}
    read = [signal for block in diagram.blocks for signal in block.input_labels]
    connect = np.zeros((len(read), len(columns)))
    entry = np.zeros((len(read), len(diagram.open_inputs)))
    for row, signal in enumerate(read):
        if signal in columns:
            connect[row, columns[signal]] = 1.0
        else:
            entry[row, diagram.open_inputs.index(signal)] = 1.0
    exits = np.zeros((len(diagram.chosen_outputs), len(columns) + len(read)))
    for i, signal in enumerate(diagram.chosen_outputs):
        exits[i, columns[signal]] = 1.0
    return {"connect_map": connect, "input_map": entry, "output_map": exits}


def own_params(diagram: Any, given: Mapping[str, float]) -> dict[str, float]:
    """Return the diagram's own of the parameters that python-control hands over.

    In an interconnection there are those of other systems among them; alone, an unknown one is refused.
    """
    joined = diagram.params.keys() <= given.keys()
    for key in given.keys() - diagram.params.keys():
        if not joined or any(key.startswith(f"{block.name}.") for block in diagram.blocks):
            raise WiringError(f"the diagram has no parameter '{key}'; {nearest(key, list(diagram.params))}")
    return {key: value for key, value in given.items() if key in diagram.params}
