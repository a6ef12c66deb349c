"""Lag of the positioner: the stem follows with the time constant ``tau`` [s]."""

from collections.abc import Mapping
from typing import Any

from blocks.block import Block
from blocks.first_order import FirstOrder
from blocks.role import Role
from diagram.diagram import Diagram
from gap.effect import Parameter, not_below
from gap.inserted import Inserted


class PositionerLag(Inserted):
    """A valve whose stem lags.

    >>> from plant.loops import self_regulating_loop
    >>> PositionerLag().insert(self_regulating_loop(), "valve", tau=2.0)["valve:positioner_lag"].params["tau"]
    2.0
    """

    name = "positioner_lag"
    role = Role.VALVE
    parameters = (Parameter("tau", "s", 0.0, 0.02, 3.0, "log", "time"),)
    where = "at"
    state = "PV"

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the lag."""
        return FirstOrder(1.0, 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the time constant of the lag."""
        return {f"{self.block(place)}.tau": values["tau"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"tau": 0.0})
