"""Time constant of the process: ``factor`` times the model's.

For a process with a time constant ``tau``, an integrating one with a time ``T``, or one of second order with a natural
frequency ``omega`` (which goes down).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, above


class ProcessTimeConstant(Effect):
    """A process faster or slower than the model.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ProcessTimeConstant().insert(self_regulating_loop(), "process", factor=1.5)["process"].params["tau"]
    15.0
    """

    name = "process_time_constant"
    role = Role.PROCESS
    parameters = (Parameter("factor", "-", 1.0, 0.2, 5.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the process has a time constant."""
        return any(key in block.param_names for key in ("tau", "T", "omega"))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the time constant, or the natural frequency."""
        own = diagram[place].params
        for key in ("tau", "T"):
            if key in own:
                return {f"{place}.{key}": own[key] * values["factor"]}
        return {f"{place}.omega": own["omega"] / values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
