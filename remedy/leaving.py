"""What it costs to leave the stick: the fitted loops with it and without it, under the load that the record had.

    ratio  = sd(SP - PV) with stick / without            travel = travel of the stem with stick - without   [unit/h]

A loop in which no stick is believed costs nothing: ratio 1, travel 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.measures.repair import FREE
from stickslip.remedy.size import Size, size_of
from stickslip.remedy.trial import NOTHING, Outcome, outcomes

__all__ = ["Cost", "cost", "cost_between"]


@dataclass(frozen=True)
class Cost:
    """``ratio`` of standard deviations of SP - PV [-], and ``travel`` caused by the stick [unit of OP per h]."""

    ratio: Size
    travel: Size

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"pv_sd_ratio": self.ratio.to_dict(), "travel_per_h": self.travel.to_dict()}

    def words(self, unit: str) -> str:
        """It in a sentence."""
        swing, more = f"With the stick SP - PV swings {self.ratio} times as far", self.travel
        word = "more"
        if more.value is not None and more.value < 0.0:  # a free stem follows the noise in OP too
            more, word = Size(-more.value, -(more.high or 0.0), -(more.low or 0.0)), "less"
        return f"{swing}, and the stem travels {more} {unit}/h {word}."


def cost_between(none: Outcome, free: Outcome) -> Cost:
    """The cost from what loops do as they are and without stick."""
    return Cost(size_of(none.pv_sd / np.maximum(free.pv_sd, 1e-300)), size_of(none.travel - free.travel))


def cost(fit: LoopFit) -> Cost:
    """Return what the stick of a fitted loop costs.

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> cost(fit(sticky())).ratio.value > 1.2
    True
    """
    if not fit.sticks:
        return Cost(Size(1.0, 1.0, 1.0), Size(0.0, 0.0, 0.0))
    none, free = outcomes(fit, [NOTHING, FREE])
    return cost_between(none, free)
