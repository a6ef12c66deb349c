"""A second lag of the process, of time constant ``tau`` [s], behind the one that the model has."""

from collections.abc import Mapping
from typing import Any

from blocks.block import Block
from blocks.first_order import FirstOrder
from blocks.role import Role
from diagram.diagram import Diagram
from gap.effect import Parameter, not_below
from gap.inserted import Inserted


class SecondLag(Inserted):
    """A process of one order more.

    >>> from plant.loops import self_regulating_loop
    >>> SecondLag().insert(self_regulating_loop(), "process", tau=2.0)["process:second_lag"].params["tau"]
    2.0
    """

    name = "second_lag"
    role = Role.PROCESS
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
