"""Gain of the process: ``factor`` times the model's.

A process with a gain ``K`` has another one; in front of any other with one input stands a gain.  Not of a line, whose
``K`` is its friction (``line_friction``).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, above
from stickslip.gap.insertion.inserted import Inserted


class ProcessGain(Inserted):
    """A process of another gain.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ProcessGain().insert(self_regulating_loop(), "process", factor=1.2)["process"].params["K"]
    3.5999999999999996
    """

    name = "process_gain"
    role = Role.PROCESS
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"),)
    where = "before"

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the process has a gain, or one input, and is no line."""
        if isinstance(block, FlowResistance):
            return False
        return "K" in block.param_names or len(block.input_labels) == 1

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a gain in front of a process that has none."""
        return diagram if "K" in diagram[place].param_names else super().put(diagram, place)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the gain."""
        return Gain("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the gain of the process, or of what stands in front."""
        if "K" in diagram[place].param_names:
            return {f"{place}.K": diagram[place].params["K"] * values["factor"]}
        return {f"{self.block(place)}.factor": values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
