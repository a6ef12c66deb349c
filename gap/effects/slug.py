"""Slugs at the feed: a saw-tooth of ``amplitude`` [unit of the process input] and ``period`` [s].

It rises slowly over 80 % of the period and falls fast over 20 % (``stickslip.blocks.periodic``); ``amplitude`` is half
of its height, ``phase`` [share of a period] where in the period it is at time 0, 0 in the middle of the rise.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.periodic import Slug as Wave
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.insertion.effect import Parameter, above, not_below

RISE = 0.8  # share of the period


class Slug(Disturbance):
    """A load that comes in slugs.

    >>> from stickslip.blocks import Constant, FirstOrder
    >>> from stickslip.diagram import wire
    >>> load = wire([Constant("load", 0.0, name="feed").with_role("disturbance"), FirstOrder(3.0, 10.0, inputs="load")])
    >>> Slug().insert(load, "feed", amplitude=0.1, period=60.0, phase=0.5).params["feed:slug/wave.start"]
    -30.0
    """

    name = "slug"
    parameters = (
        Parameter("amplitude", "process input", 0.0, 0.0005, 0.5, "log", "size"),
        Parameter("period", "s", 600.0, 2.0, 300.0, "log", "time"),
        Parameter("phase", "-", 0.0, 0.0, 1.0, nuisance=True),
    )

    def plan(self, phase: ArrayLike) -> Floats:
        """Return the wave of amplitude 1 at phases [share of a period], any shape."""
        risen = (np.asarray(phase, dtype=float) + 0.5 * RISE) % 1.0  # since it was lowest
        return np.where(risen < RISE, 2.0 * risen / RISE - 1.0, 1.0 - 2.0 * (risen - RISE) / (1.0 - RISE))

    def wave(self) -> Block:
        """Return the saw-tooth."""
        return Wave("wave", 0.0)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return amplitude, period and begin of the saw-tooth."""
        wave = f"{self.block(place)}/wave"
        found = {f"{wave}.{key}": values[key] for key in ("amplitude", "period")}
        return found | {f"{wave}.start": -values["phase"] * values["period"]}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the amplitude is zero."""
        return values["amplitude"] == 0.0

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"amplitude": 0.0}) or above(values, "period", remedy="give seconds")
