"""A sine at the feed: ``amplitude`` [unit of the process input], ``period`` [s]; ``phase`` [share of a period]."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.periodic import Sine
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.insertion.effect import Parameter, above, not_below


class SineDisturbance(Disturbance):
    """A load that swings.

    >>> from stickslip.blocks import Constant, FirstOrder
    >>> from stickslip.diagram import wire
    >>> load = wire([Constant("load", 0.0, name="feed").with_role("disturbance"), FirstOrder(3.0, 10.0, inputs="load")])
    >>> SineDisturbance().insert(load, "feed", amplitude=0.1, period=60.0).params["feed:sine_disturbance/wave.period"]
    60.0
    """

    name = "sine_disturbance"
    parameters = (
        Parameter("amplitude", "process input", 0.0, 0.0005, 0.5, "log", "size"),
        Parameter("period", "s", 60.0, 0.5, 300.0, "log", "time"),
        Parameter("phase", "-", 0.0, 0.0, 1.0, nuisance=True),
    )

    def plan(self, phase: ArrayLike) -> Floats:
        """Return the wave of amplitude 1 at phases [share of a period], any shape."""
        return np.sin(2.0 * np.pi * np.asarray(phase, dtype=float))

    def wave(self) -> Block:
        """Return the sine."""
        return Sine("wave", 0.0)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return amplitude, period and phase of the sine."""
        wave = f"{self.block(place)}/wave"
        found = {f"{wave}.{key}": values[key] for key in ("amplitude", "period")}
        return found | {f"{wave}.phase": 2.0 * math.pi * values["phase"]}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the amplitude is zero."""
        return values["amplitude"] == 0.0

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"amplitude": 0.0}) or above(values, "period", remedy="give seconds")
