"""Dead time: what enters the process arrives later by ``theta`` [s].

A process that has a dead time of its own gets that much more; in front of any other with one input stands a delay.
Not for a block that several signals enter: which of them is late is another question.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block
from stickslip.blocks.dead_time import DeadTime as Delay
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Parameter, known_first, not_below
from stickslip.gap.insertion.inserted import Inserted
from stickslip.gap.insertion.paths import made_of


class DeadTime(Inserted):
    """More dead time at a process.

    >>> from stickslip.plant.loops import self_regulating_loop
    >>> DeadTime().insert(self_regulating_loop(), "process", theta=2.0)["process"].params["theta"]
    2.0
    """

    name = "dead_time"
    role = Role.PROCESS
    parameters = (Parameter("theta", "s", 0.0, 0.01, 3.0, "log", "time"),)
    where = "before"

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether one signal enters the process."""
        return len(block.input_labels) == 1

    def made(self, diagram: Diagram, place: str) -> Block:
        """Return the delay."""
        return Delay(1.0, name=self.block(place))

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with a delay in front of a process without one."""
        return diagram if diagram[place].dead_time_param else super().put(diagram, place)

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the dead time as a parameter of the process, or of the delay in front of it."""
        own = diagram[place].dead_time_param
        key = f"{place}.{own}" if own else f"{self.block(place)}.theta"
        return {key: diagram[place].dead_time + values["theta"]}

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with the values."""
        return not_below(values, {"theta": 0.0})

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the delay full of the first value of what enters it, or of what that is made of."""
        block = diagram[place if diagram[place].dead_time_param else self.block(place)]
        before = known_first(first, made_of(diagram, str(block.input_labels[0])), block.value_before)
        return diagram.with_params({f"{block.name}.{block.before_param}": before})
