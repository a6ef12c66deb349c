"""Effects that are a factor on one signal u, about zero or about a value where the model is right.

    factor u                      where ``at`` is not given: all of the signal is larger
    at + factor (u - at)          a model that was fitted at one operating point has the right level there

``at`` costs a fit one more value, so it is taken only where it gains more than that.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import NOMINAL, above
from stickslip.gap.insertion.inserted import Inserted


class FactorAbout(Inserted):
    """An effect with the parameters ``factor`` [-] and ``at`` [in ``unit_of``], which is NaN for none."""

    level = "at"

    def signal(self, diagram: Diagram, place: str) -> str:
        """Return the signal that the factor is on."""
        raise NotImplementedError

    def unit_of(self, diagram: Diagram, place: str) -> float:
        """Return one unit of ``at`` [unit of the signal]."""
        return 1.0

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the factor, and what keeps the level."""
        return Sum("out", {"in": 1.0}, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the factor and the offset that keeps the level."""
        level = np.nan_to_num(values.get("at", NOMINAL)) * self.unit_of(diagram, place)
        factor, block = values["factor"], self.block(place)
        return {f"{block}.w_in": factor, f"{block}.offset": (1.0 - factor) * level}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the factor is 1."""
        return values["factor"] == 1.0

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
