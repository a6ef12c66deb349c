"""Effects that are one more first-order lag in a signal's path."""

from collections.abc import Mapping
from typing import Any

from blocks.block import Block
from blocks.first_order import FirstOrder
from diagram.diagram import Diagram
from gap.insertion.effect import Parameter, not_below
from gap.insertion.inserted import Inserted


class Lag(Inserted):
    """A lag of time constant ``tau`` [s], neutral at 0, that starts settled; each effect says ``where``."""

    parameters = (Parameter("tau", "s", 0.0, 0.02, 3.0, "log", "time"),)
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
