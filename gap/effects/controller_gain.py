"""Gain of the controller: ``factor`` times K_p, and with it K_p/T_i."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, above


class ControllerGain(Effect):
    """A controller tuned to another gain.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ControllerGain().insert(self_regulating_loop(), "controller", factor=2.0)["controller"].params["K_p"]
    0.8
    """

    name = "controller_gain"
    role = Role.CONTROLLER
    parameters = (Parameter("factor", "-", 1.0, 0.2, 5.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the controller has a gain."""
        return "K_p" in block.param_names

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the gain."""
        return {f"{place}.K_p": diagram[place].params["K_p"] * values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
