"""Limited travel: the stem stops short at ``low`` or ``high`` [% of travel]; the controller does not know."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.blocks.saturation import Saturation
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.inserted import Inserted, percent_of_stem


class ValveSaturation(Inserted):
    """A valve with stops inside its travel; 0 and 100 % stand for none of its own.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ValveSaturation().insert(self_regulating_loop(), "valve", high=80.0)["valve:valve_saturation"].params["high"]
    0.8
    """

    name = "valve_saturation"
    role = Role.VALVE
    parameters = (Parameter("low", "% travel", 0.0, 0.0, 60.0), Parameter("high", "% travel", 100.0, 40.0, 100.0))
    where = "at"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the stops."""
        return Saturation("out", "in", 0.0, 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the stops in units of the stem."""
        percent, name = percent_of_stem(diagram, place), self.block(place)
        low, high = (np.asarray(values[key], dtype=float) for key in ("low", "high"))
        ends = np.where(low > 0.0, low * percent, -np.inf), np.where(high < 100.0, high * percent, np.inf)
        return {f"{name}.low": ends[0][()], f"{name}.high": ends[1][()]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if 0.0 <= values["low"] < values["high"] <= 100.0:
            return ""
        said = f"low = {values['low']:g} %, high = {values['high']:g} %"
        return f"{said}, but the stops lie within 0 to 100 %, low below high; correct them"
