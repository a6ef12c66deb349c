"""Saturation of the sensor: it shows nothing below ``low`` or above ``high`` [unit of PV]."""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.saturation import Saturation
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.inserted import Inserted


class SensorSaturation(Inserted):
    """A sensor with a range.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorSaturation().insert(sensor, "sensor", high=1.0)["sensor:sensor_saturation"].params["high"]
    1.0
    """

    name = "sensor_saturation"
    role = Role.SENSOR
    parameters = (
        Parameter("low", "PV", -math.inf, -0.5, 0.7, per="span"),
        Parameter("high", "PV", math.inf, 0.3, 1.5, per="span"),
    )
    where = "at"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the limits."""
        return Saturation("out", "in", name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the limits."""
        return {f"{self.block(place)}.{key}": values[key] for key in ("low", "high")}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["low"] < values["high"]:
            return ""
        return f"low = {values['low']:g}, but it must be below high = {values['high']:g}; correct them"
