"""Deadband: play between what the valve is to do and its stem, by ``width`` [% of OP's span].

It is a stiction without slip jump: S = ``width``, J = 0.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.deadband import Deadband as Play
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, not_below
from stickslip.gap.insertion.inserted import Inserted, percent_of_stem


class Deadband(Inserted):
    """A valve with play (``stickslip.blocks.deadband``).

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> Deadband().insert(self_regulating_loop(), "valve", width=5.0)["valve:deadband"].params["width"]
    0.05
    """

    name = "deadband"
    role = Role.VALVE
    parameters = (Parameter("width", "% OP", 0.0, 0.1, 20.0, "log"),)
    where = "at"
    state = "x"
    hidden = True

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the play."""
        return Play(0.01, low=-math.inf, high=math.inf, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the width in units of the stem."""
        return {f"{self.block(place)}.width": values["width"] * percent_of_stem(diagram, place)}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"width": 0.0})
