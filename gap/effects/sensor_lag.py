"""Lag of the sensor, of time constant ``tau`` [s]: the logged PV is behind it, its noise is not filtered."""

from stickslip.blocks.role import Role
from stickslip.gap.insertion.lag import Lag


class SensorLag(Lag):
    """A slow sensor.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorLag().insert(sensor, "sensor", tau=2.0)["sensor:sensor_lag"].params["tau"]
    2.0
    """

    name = "sensor_lag"
    role = Role.SENSOR
    where = "before"
