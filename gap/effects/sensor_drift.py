"""Drift: what the sensor shows grows by ``rate`` [unit of PV per h] from time 0 of the run on."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.sensor import Sensor
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, finite
from stickslip.gap.insertion.inserted import Inserted


class SensorDrift(Inserted):
    """A sensor that drifts.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorDrift().insert(sensor, "sensor", rate=3.6)["sensor:sensor_drift"].params["drift"]
    0.001
    """

    name = "sensor_drift"
    role = Role.SENSOR
    parameters = (Parameter("rate", "PV/h", 0.0, -0.5, 0.5, per="span"),)
    where = "before"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the drift."""
        return Sensor(name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the drift per second."""
        return {f"{self.block(place)}.drift": values["rate"] / 3600.0}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return finite(values, "rate")
