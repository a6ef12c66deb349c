"""Effects that are a slower first-order lag in a signal's path: a lag that the model has, or one more."""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, not_below
from stickslip.gap.insertion.inserted import Inserted
from stickslip.gap.insertion.paths import measured


class Lag(Inserted):
    """A lag whose time constant is longer by ``tau`` [s], neutral at 0; each effect says ``where``.

    It is the lag that the model has there; where the model has none, it is one more, which starts settled.
    """

    parameters = (Parameter("tau", "s", 0.0, 0.02, 3.0, "log", "time"),)
    state = "PV"

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the lag."""
        return diagram if self.own(diagram, place) else super().put(diagram, place)

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the lag."""
        return FirstOrder(1.0, 1.0, name=self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the time constant of the lag."""
        own = self.own(diagram, place)
        if own is None:
            return {f"{self.block(place)}.tau": values["tau"]}
        block, _, name = own.rpartition(".")
        return {own: float(diagram[block].params[name]) + values["tau"]}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the lag settled, if it is one more."""
        return diagram if self.own(diagram, place) else super().started(diagram, place, first)

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"tau": 0.0})

    def own(self, diagram: Diagram, place: str) -> str | None:
        """Return the time constant of the lag that the model has at a place, ``block.parameter``; None for none.

        It is that of the place itself, or of a filter that only the place reads.
        """
        at = diagram[place]
        near = [at]
        signal = measured(diagram, at) if self.role is Role.SENSOR else str(at.input_labels[0])
        if signal in diagram.driven:
            before = diagram.blocks[diagram.driven[signal][0]]
            if before.role is Role.FILTER and [b for b in diagram.blocks if signal in b.input_labels] == [at]:
                near.append(before)
        for block in near:
            if block.lag_param and block.params[block.lag_param] > 0.0 and block.params.get("T_lead", 0.0) == 0.0:
                return f"{block.name}.{block.lag_param}"
        return None
