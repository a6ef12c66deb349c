"""Rate limit: the stem moves no faster than ``rate`` [% of travel per s], either way."""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.rate_limiter import RateLimiter
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.inserted import Inserted, percent_of_stem


class ValveRateLimit(Inserted):
    """A valve whose stem is slow.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> ValveRateLimit().insert(self_regulating_loop(), "valve", rate=2.0)["valve:valve_rate_limit"].params["down"]
    0.02
    """

    name = "valve_rate_limit"
    role = Role.VALVE
    parameters = (Parameter("rate", "% travel/s", math.inf, 0.02, 50.0, "log"),)
    where = "at"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the rate limiter."""
        return RateLimiter("out", "in", 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rate in units of the stem."""
        rate = values["rate"] * percent_of_stem(diagram, place)
        return {f"{self.block(place)}.{side}": rate for side in ("up", "down")}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["rate"] > 0.0:
            return ""
        return f"rate = {values['rate']:g} %/s, but a stem that moves has a rate above 0; leave it out for no limit"
