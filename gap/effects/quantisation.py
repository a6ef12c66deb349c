"""Quantisation: the sensor gives multiples of ``step`` [unit of PV], in the loop: the controller sees them.

A sampled sensor rounds its samples; behind a continuous one stands a quantiser (``stickslip.blocks.quantiser``).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.quantiser import Quantiser
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, not_below
from stickslip.gap.insertion.inserted import Inserted


class Quantisation(Inserted):
    """A sensor of few bits.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> Quantisation().insert(sensor, "sensor", step=0.1)["sensor:quantisation"].params["step"]
    0.1
    """

    name = "quantisation"
    role = Role.SENSOR
    parameters = (Parameter("step", "PV", 0.0, 0.0005, 0.2, "log", "span"),)
    where = "at"

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a quantiser behind a sensor that has no step of its own."""
        return diagram if "step" in diagram[place].param_names else super().put(diagram, place)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the quantiser."""
        return Quantiser("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the step."""
        own = "step" in diagram[place].param_names
        return {f"{place if own else self.block(place)}.step": values["step"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"step": 0.0})
