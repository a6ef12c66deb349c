"""A step at the feed: the load changes by ``amplitude`` [unit of the process input] at ``time`` [s] and stays."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.sources import Step
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.insertion.effect import Parameter, finite


class StepDisturbance(Disturbance):
    """A load that steps.

    >>> from stickslip.blocks import Constant, FirstOrder
    >>> from stickslip.diagram import wire
    >>> load = wire([Constant("load", 0.0, name="feed").with_role("disturbance"), FirstOrder(3.0, 10.0, inputs="load")])
    >>> StepDisturbance().insert(load, "feed", amplitude=0.1, time=60.0).params["feed:step_disturbance/wave.at"]
    60.0
    """

    name = "step_disturbance"
    parameters = (
        Parameter("amplitude", "process input", 0.0, -0.5, 0.5, per="size"),
        Parameter("time", "s", 0.0, 0.0, 86400.0),
    )

    def wave(self) -> Block:
        """Return the step."""
        return Step("wave", 0.0)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return height and time of the step."""
        wave = f"{self.block(place)}/wave"
        return {f"{wave}.after": values["amplitude"], f"{wave}.at": values["time"]}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the amplitude is zero."""
        return values["amplitude"] == 0.0

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "amplitude", "time")
