"""Ramp of the set point: what the controller reads follows SP no faster than ``rate`` [unit of PV per s].

A controller that scans moves it by ``rate`` dt at most from one scan to the next.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.rate_limiter import RateLimiter
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.insertion.of_controller import AtScans, OfController


def _step(x: float, in_: float, rate: float, dt: float) -> tuple[float, float]:
    x += min(max(in_ - x, -rate * dt), rate * dt)
    return x, x


class ScannedRamp(AtScans):
    """A signal that moves by ``rate`` [unit per s] at most, at the scans of a controller.

    >>> from stickslip.diagram import drive
    >>> drive(ScannedRamp("y", "u", {"rate": 0.4}, dt=1.0), 3.0, every=1.0, u=1.0).log["y"].round(9).tolist()
    [0.4, 0.8, 1.0, 1.0]
    """

    kernels = Kernels(step=_step)


class SetpointRamp(OfController):
    """A controller that takes its set point to a new value in a ramp.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> SetpointRamp().insert(self_regulating_loop(), "controller", rate=0.1)["controller:setpoint_ramp"].params["up"]
    0.1
    """

    name = "setpoint_ramp"
    parameters = (Parameter("rate", "PV/s", math.inf, 1e-5, 0.2, "log", "span"),)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the limiter of the rate."""
        at = diagram[place]
        if not at.sampled:
            return RateLimiter("out", "in", 1.0, name=self.block(place))
        return ScannedRamp("out", "in", {"rate": 1.0}, **self.scans(at), name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the rate, both ways."""
        sides = ("rate",) if diagram[place].sampled else ("up", "down")
        return {f"{self.block(place)}.{side}": values["rate"] for side in sides}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with a ramp that stands at the first set point."""
        own = diagram[self.block(place)]
        known = first.get(str(own.input_labels[0]))
        return diagram if known is None or not own.sampled else diagram.starting_at({f"{own.name}.x": known})

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if values["rate"] > 0.0:
            return ""
        return f"rate = {values['rate']:g} per s, but a ramp that moves has a rate above 0; leave it out for no ramp"
