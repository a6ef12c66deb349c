"""Gain of the process: ``factor`` times the model's, of all that enters it or of what goes beyond ``at`` [its unit].

    a process with one input            at + factor (u - at) enters, factor u without ``at``
    an integrator, or several inputs    the gain K is ``factor`` times the model's

Not of a line, whose ``K`` is its friction (``line_friction``).
"""

from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.about import FactorAbout
from stickslip.gap.insertion.effect import NOMINAL, Parameter
from stickslip.gap.insertion.scales import ends


class ProcessGain(FactorAbout):
    """A process of another gain.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ProcessGain().insert(self_regulating_loop(), "process", factor=1.2)["process:process_gain"].params["w_in"]
    1.2
    """

    name = "process_gain"
    role = Role.PROCESS
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"), Parameter("at", "input", NOMINAL, 0.0, 1.0))
    where = "before"

    def signal(self, diagram: Diagram, place: str) -> str:
        """Return what enters the process, "" if that is several signals or an integrator has a level of its own."""
        block = diagram[place]
        return str(block.input_labels[0]) if len(block.input_labels) == 1 and not isinstance(block, Integrator) else ""

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the process has a gain, or one input, and is no line."""
        if isinstance(block, FlowResistance):
            return False
        return "K" in block.param_names or len(block.input_labels) == 1

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a factor in front of a process that has one input."""
        return super().put(diagram, place) if self.signal(diagram, place) else diagram

    def bounds(self, diagram: Diagram, place: str) -> dict[str, tuple[float, float]]:
        """Return parameter -> (low, high); ``at`` lies within the span of what enters the process."""
        signal = self.signal(diagram, place)
        within = ends(diagram, signal) if signal else None
        return super().bounds(diagram, place) | {"at": within or (0.0, 1.0)}

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the factor in front of the process, or its gain."""
        if self.signal(diagram, place):
            return super().settings(diagram, place, **values)
        return {f"{place}.K": diagram[place].params["K"] * values["factor"]}
