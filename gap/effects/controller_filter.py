"""Filter of the controller: the error passes a lag of time constant ``tau`` [s], behind the logged PV.

The same lag in SP and in PV is that lag in the error.  A controller that scans computes it at its scans, with the
coefficient 1 - exp(-dt/tau).
"""

from collections.abc import Mapping
from typing import Any, ClassVar

from stickslip.blocks.block import Block
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.role import Role
from stickslip.blocks.sampled_filter import SampledFilter
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect, Parameter, not_below


class ControllerFilter(Effect):
    """A controller that filters its error.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> filtered = ControllerFilter().insert(self_regulating_loop(), "controller", tau=2.0)
    >>> filtered["controller"].input_labels
    ['SP:controller:controller_filter SP', 'PV:controller:controller_filter PV']
    """

    name = "controller_filter"
    role = Role.CONTROLLER
    parameters = (Parameter("tau", "s", 0.0, 0.02, 3.0, "log", "time"),)
    reads: ClassVar[tuple[str, ...]] = ("SP", "PV")

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the controller reads what is filtered."""
        return all(block.loop_signal(part) in block.input_labels for part in self.reads)

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a lag in each part of what the controller reads."""
        for part in self.reads:
            signal = str(diagram[place].loop_signal(part))
            diagram = diagram.insert(signal, self._lag(diagram[place], part), readers=place)
        return diagram

    def _lag(self, controller: Block, part: str) -> Block:
        name = f"{self.block(controller.name)} {part}"
        if controller.sampled:
            offset = controller.params.get(controller.offset_param or "", 0.0)
            return SampledFilter("out", "in", 1.0, controller.period, offset=offset, name=name)
        return FirstOrder(1.0, 1.0, name=name)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the time constant of each lag."""
        return {f"{self.block(place)} {part}.tau": values["tau"] for part in self.reads}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with each lag settled at the first value of what it reads."""
        lags = [diagram[f"{self.block(place)} {part}"] for part in self.reads]
        start = {
            f"{lag.name}.{'y' if lag.sampled else 'PV'}": first[str(lag.input_labels[0])]
            for lag in lags
            if lag.input_labels[0] in first
        }
        return diagram.starting_at(start)

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"tau": 0.0})
