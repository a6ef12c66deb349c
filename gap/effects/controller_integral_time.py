"""Integral time of the controller: ``factor`` times T_i."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, above


class ControllerIntegralTime(Effect):
    """A controller tuned to another integral time.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ControllerIntegralTime().insert(self_regulating_loop(), "controller", factor=1.5)["controller"].params["T_i"]
    15.0
    """

    name = "controller_integral_time"
    role = Role.CONTROLLER
    parameters = (Parameter("factor", "-", 1.0, 0.2, 5.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the controller has an integral time."""
        return "T_i" in block.param_names

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the integral time."""
        return {f"{place}.T_i": diagram[place].params["T_i"] * values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
