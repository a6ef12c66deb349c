"""Bias: the sensor shows ``offset`` [unit of PV] too much."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Gain
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, finite
from stickslip.gap.insertion.inserted import Inserted


class SensorBias(Inserted):
    """A sensor with a bias.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorBias().insert(sensor, "sensor", offset=0.1)["sensor:sensor_bias"].params["offset"]
    0.1
    """

    name = "sensor_bias"
    role = Role.SENSOR
    parameters = (Parameter("offset", "PV", 0.0, -0.5, 0.5, per="span"),)
    where = "before"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the offset."""
        return Gain("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the offset."""
        return {f"{self.block(place)}.offset": values["offset"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "offset")
