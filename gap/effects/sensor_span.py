"""Span error: the sensor shows ``factor`` times what there is, about the low end of its range where it states one.

shown = low + factor (x - low)
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, above
from stickslip.gap.insertion.inserted import Inserted


class SensorSpan(Inserted):
    """A sensor of a wrong span.

    >>> from stickslip.blocks import Sensor
    >>> from stickslip.diagram import wire
    >>> sensor = wire([Sensor(inputs="y", outputs="PV")], inputs=["y"])
    >>> SensorSpan().insert(sensor, "sensor", factor=1.1)["sensor:sensor_span"].params["w_in"]
    1.1
    """

    name = "sensor_span"
    role = Role.SENSOR
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"),)
    where = "before"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the factor, and what keeps the low end."""
        return Sum("out", {"in": 1.0}, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the factor and the offset that keeps the low end."""
        low = diagram[place].params.get("low", 0.0)
        own, factor = self.block(place), values["factor"]
        return {f"{own}.w_in": factor, f"{own}.offset": (1.0 - factor) * (low if math.isfinite(low) else 0.0)}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
