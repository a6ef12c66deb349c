"""Limits of the controller: OP stays within ``low`` and ``high`` [% of OP's span], not within the model's limits."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import NOMINAL, Effect, Parameter


class ControllerLimits(Effect):
    """A controller with other limits of its output.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ControllerLimits().insert(self_regulating_loop(), "controller", high=80.0)["controller"].limits
    (-inf, 0.8)
    """

    name = "controller_limits"
    role = Role.CONTROLLER
    parameters = (Parameter("low", "% OP", NOMINAL, 0.0, 60.0), Parameter("high", "% OP", NOMINAL, 40.0, 100.0))

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the output of the controller is limited by two parameters."""
        return block.limit_params is not None and len(block.output_labels) == 1

    def nominal(self, diagram: Diagram, place: str) -> dict[str, float]:
        """Return the limits of the model."""
        start, percent = _percent(diagram, place)
        low, high = diagram[place].limits
        return {"low": (low - start) / percent, "high": (high - start) / percent}

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the limits in units of OP."""
        start, percent = _percent(diagram, place)
        ends = diagram[place].limit_params or ()
        return {f"{place}.{end}": start + values[key] * percent for end, key in zip(ends, ("low", "high"), strict=True)}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["low"] < values["high"]:
            return ""
        return f"low = {values['low']:g} %, but it must be below high = {values['high']:g} %; correct them"


def _percent(diagram: Diagram, place: str) -> tuple[float, float]:
    """Return the low end and one percent of the span of OP [its unit]."""
    low, high = diagram.signal_spans.get(str(diagram[place].output_labels[0]), (0.0, 1.0))
    return low, (high - low) / 100.0
