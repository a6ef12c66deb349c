"""Noise of the sensor: ``factor`` times the standard deviation that the model states.

For a sensor that draws noise, or reads a source of it.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, not_below
from stickslip.gap.insertion.paths import noise_of


class SensorNoise(Effect):
    """A sensor that is noisier, or quieter, than it should be.

    >>> from stickslip.blocks import SampledSensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([SampledSensor(dt=1.0, sd=0.1, inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorNoise().insert(sensor, "sensor", factor=3.0)["sensor"].params["sd"].__round__(9)
    0.3
    """

    name = "sensor_noise"
    role = Role.SENSOR
    parameters = (Parameter("factor", "-", 1.0, 0.2, 20.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the model says how noisy the sensor is."""
        return noise_of(diagram, block) is not None

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the standard deviation."""
        noise = str(noise_of(diagram, diagram[place]))
        return {f"{noise}.sd": diagram[noise].params["sd"] * values["factor"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"factor": 0.0}, "give 1 for the noise of the model")
