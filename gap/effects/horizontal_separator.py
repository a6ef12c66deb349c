"""Horizontal separator: the level stands for less liquid near bottom and top than the model says.

    V_seen = V + share (V_sep h(V/V_sep) - V)

h is the level, in diameters, at which a lying cylinder is filled to a share of its volume; ``share`` [-] is 1 for a
lying cylinder and 0 for the model's upright vessel.  Whoever reads the volume sees what the level shows.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.lookup_1d import Lookup1D
from stickslip.blocks.role import Role
from stickslip.blocks.separator import Separator
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter

POINTS = 61


class HorizontalSeparator(Effect):
    """A separator that lies.

    >>> from stickslip.plant import production_plant
    >>> plant = HorizontalSeparator().insert(production_plant(), "S1", share=1.0)
    >>> plant["LCS11"].input_labels, plant["S1"].output_labels[1]
    (['SP_LCS11', 'V_1'], 'V_1:S1')
    """

    name = "horizontal_separator"
    role = Role.PROCESS
    parameters = (Parameter("share", "-", 0.0, 0.0, 1.0),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block is a separator."""
        return isinstance(block, Separator)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the table of the cylinder in the path of the volume."""
        full = diagram[place].params["V_sep"]
        level, filled = cylinder()
        seen = Lookup1D("lying", "in", full * filled, full * level, beyond="extend")
        added = Sum("out", {"in": 1.0, "lying": 0.0}, name="sum")
        signal = str(diagram[place].output_labels[1])
        return diagram.insert(signal, wire([seen, added], ["in"], ["out"], name=self.block(place)))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the weights of the two readings."""
        added = f"{self.block(place)}/sum"
        return {f"{added}.w_in": 1.0 - values["share"], f"{added}.w_lying": values["share"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        if 0.0 <= values["share"] <= 1.0:
            return ""
        return f"share = {values['share']:g}, but it is from 0 (upright) to 1 (lying); correct it"


def cylinder() -> tuple[Floats, Floats]:
    """Return levels [diameters] of a lying cylinder and the shares of its volume that are filled then, (points,) each.

    >>> level, filled = cylinder()
    >>> level[30].round(9), filled[30].round(9)
    (np.float64(0.5), np.float64(0.5))
    """
    level = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, POINTS)))
    angle = 2.0 * np.arccos(1.0 - 2.0 * level)
    return level, (angle - np.sin(angle)) / (2.0 * np.pi)
