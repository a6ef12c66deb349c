"""Effects that are one block in the path of a signal: most of them.

at       what the place gives goes through the block, and whoever reads or logs it sees the effect; at a valve that
         gives its flow, what enters it (``stickslip.gap.insertion.bent_valve``)
after    the same for those who use it, while a log still shows what the place gave: flow behind the stem position
before   what enters the place goes through the block, and nobody else sees it
"""

from collections.abc import Mapping
from typing import ClassVar, Literal

from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.bent_valve import stem_signal, with_stem
from stickslip.gap.insertion.effect import Effect, known_first
from stickslip.gap.insertion.paths import command, given, measured, users
from stickslip.gap.insertion.scales import ends, span


class Inserted(Effect):
    """An effect that is one block, which ``made`` returns; ``where`` it lies, the ``state`` it starts settled in."""

    where: ClassVar[Literal["at", "after", "before"]] = "at"
    state: ClassVar[str] = ""

    def made(self, diagram: Diagram, place: str) -> Block | Diagram:
        """Return the block of the effect, with any values that it may have."""
        raise NotImplementedError

    def enters(self, diagram: Diagram, block: Block) -> str | None:
        """Return the signal that enters the block through an effect before it, None if it is not clear which."""
        return measured(diagram, block)

    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether one signal goes in or out where the effect lies, and somebody uses it."""
        if self.where == "before":
            return self.enters(diagram, block) is not None
        if not (_clear(block) if self.role is Role.VALVE else len(block.output_labels) == 1):
            return False
        return self.where == "at" or bool(users(diagram, given(diagram, block.name)))

    def nowhere(self, diagram: Diagram) -> str:
        """Return why no place fits, and what to do: of a valve, that nothing says which signal moves it."""
        valves = [b for b in diagram.blocks if b.role is self.role is Role.VALVE and not _clear(b)]
        if not valves:
            return super().nowhere(diagram)
        return f"it is not clear what moves '{valves[0].name}'; say .with_role(\"valve\", OP=its input, MV=its output)"

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the block of the effect."""
        block = diagram[place]
        new = self.made(diagram, place)
        if self.where == "before":
            return diagram.insert(str(self.enters(diagram, block)), new, readers=place)
        if self.where == "at":
            return with_stem(diagram, place, new)
        signal = given(diagram, place)
        return diagram.insert(signal, new, readers=users(diagram, signal))

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram with the block settled at the first value of its signal, or of the nearest one known."""
        if not self.state:
            return diagram
        own, at = diagram[self.block(place)], diagram[place]
        read = [b for b in diagram.blocks if not {*own.output_labels}.isdisjoint(b.input_labels)]
        near = [*own.output_labels, *own.input_labels, *at.output_labels, *at.input_labels]
        near += [s for b in read for s in b.output_labels]
        key = f"{own.name}.{self.state}"
        now = float(own.x0[own.state_names.index(self.state)]) if self.state in own.state_names else 0.0
        return diagram.starting_at({key: known_first(first, map(str, near), now)})


def _clear(valve: Block) -> bool:
    """Return whether it is said which signal moves a valve, and what it gives."""
    return command(valve) is not None and (len(valve.output_labels) == 1 or valve.loop_signal("MV") is not None)


def percent_in(diagram: Diagram, place: str) -> float:
    """Return one percent of the span of what enters a valve, OP [its unit]."""
    return span(diagram, str(command(diagram[place]))) / 100.0


def percent_of_stem(diagram: Diagram, place: str) -> float:
    """Return one percent of the travel of a valve's stem [unit of what it gives, or of OP where that is a flow]."""
    return _percent(diagram, place, stem_signal(diagram, place))


def known_travel(diagram: Diagram, valve: Block) -> bool:
    """Return whether the span of what a valve gives is known: stated, or that of the only signal that it reads."""
    return len(valve.input_labels) == 1 or ends(diagram, given(diagram, valve.name)) is not None


def percent_out(diagram: Diagram, place: str) -> float:
    """Return one percent of what a valve gives, its travel: of its span, or of OP's if it states none [its unit]."""
    return _percent(diagram, place, given(diagram, place))


def _percent(diagram: Diagram, place: str, signal: str) -> float:
    return span(diagram, signal) / 100.0 if ends(diagram, signal) else percent_in(diagram, place)
