"""Effects that are a factor on one parameter of the block that is there."""

from collections.abc import Mapping
from typing import Any, ClassVar

from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, above


class Factor(Effect):
    """The parameter ``key`` is its nominal value times ``factor`` to the ``power``; where there is one is a place."""

    key: ClassVar[str] = ""
    power: ClassVar[float] = 1.0
    parameters = (Parameter("factor", "-", 1.0, 0.3, 3.0, "log"),)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the block has the parameter."""
        return self.key in block.param_names

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the parameter."""
        return {f"{place}.{self.key}": diagram[place].params[self.key] * values["factor"] ** self.power}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return above(values, "factor")
