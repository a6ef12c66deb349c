"""Which effects a diagram's wiring alone lets apart, before any data: by the logged signals whose residuals feel them.

A logged signal cuts the diagram: what follows from it is computed from the log.  So an effect shows in the residuals of
those logged signals that its place reaches without passing another logged one, and in no others.  Effects that show in
the same signals are told apart by the shape of what they do alone, or by a tag in between.
(Between two rows nothing is logged: a block behind a logged signal feels a little of what drives that in between.)
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.inserted import Inserted
from stickslip.gap.insertion.paths import ONLOOKERS, given, users


@dataclass(frozen=True)
class Together:
    """``effects`` (name, place) that show in the residuals of the same ``signals``; ``tags`` that would part them."""

    signals: tuple[str, ...]
    effects: tuple[tuple[str, str], ...]
    tags: tuple[str, ...] = ()

    @property
    def places(self) -> tuple[str, ...]:
        """The places of the effects."""
        return tuple(dict.fromkeys(place for _, place in self.effects))

    def __str__(self) -> str:
        parting = f" (a log of {' or '.join(self.tags)} would part them)" if self.tags else ""
        shows = "shows" if len(self.places) == 1 else "show"
        return f"{', '.join(self.places)} {shows} in {' and '.join(self.signals) or 'nothing'} only{parting}"


def structure(diagram: Diagram, logged: Iterable[str], catalogue: Sequence[Effect] = CATALOGUE) -> tuple[Together, ...]:
    """Return the effects of a catalogue in groups that show in the residuals of the same logged signals.

    >>> from stickslip.cases.models import ideal_flow
    >>> for group in structure(ideal_flow(), ["SP", "PV", "OP"]):
    ...     print(group)
    valve, process, sensor, feed show in PV only (a log of MV or F or y would part them)
    controller shows in OP only
    """
    known = set(logged)
    groups = _grouped(diagram, known, catalogue)
    tags = [str(s) for s in diagram.signals if s in diagram.driven and s not in known and _between(diagram, str(s))]
    found = []
    for signals, effects in groups.items():
        parting = [tag for tag in tags if _parts(diagram, known | {tag}, effects)]
        found.append(Together(signals, effects, tuple(parting)))
    return tuple(found)


def by_wiring(diagram: Diagram, logged: Iterable[str], catalogue: Sequence[Effect] = CATALOGUE) -> str:
    """Return in a sentence what the wiring lets apart: only groups of several places, which need a shape or a tag."""
    several = [str(one) for one in structure(diagram, logged, catalogue) if len(one.places) > 1]
    return "By the wiring alone " + ("; ".join(several) if several else "each place shows in signals of its own") + "."


def _grouped(
    diagram: Diagram, known: set[str], catalogue: Sequence[Effect]
) -> dict[tuple[str, ...], tuple[tuple[str, str], ...]]:
    found: dict[tuple[str, ...], tuple[tuple[str, str], ...]] = {}
    for effect in catalogue:
        if effect.of_log:
            continue
        for place in effect.places(diagram):
            signals = felt(diagram, known, effect, place)
            found[signals] = (*found.get(signals, ()), (effect.name, place))
    return found


def felt(diagram: Diagram, known: set[str], effect: Effect, place: str) -> tuple[str, ...]:
    """Return the logged signals whose residuals feel an effect at a place, in the diagram's order."""
    waiting = [str(s) for s in diagram[place].output_labels]
    if isinstance(effect, Inserted) and effect.where == "after":  # a log still shows what the place gave
        signal = given(diagram, place)
        waiting = [str(s) for name in users(diagram, signal) for s in diagram[name].output_labels]
    found, seen = set(), set(waiting)
    while waiting:
        signal = waiting.pop()
        if signal in known:
            found.add(signal)
            continue
        for name in users(diagram, signal):
            new = [str(s) for s in diagram[name].output_labels if str(s) not in seen]
            seen |= set(new)
            waiting += new
    return tuple(str(s) for s in diagram.signals if s in found)


def _parts(diagram: Diagram, known: set[str], effects: Sequence[tuple[str, str]]) -> bool:
    """Return whether effects show in different signals once these are logged."""
    by_name = {one.name: one for one in CATALOGUE}
    return len({felt(diagram, known, by_name[name], place) for name, place in effects if name in by_name}) > 1


def _between(diagram: Diagram, signal: str) -> bool:
    """Return whether a signal is one that a tag could show: neither a source nor what only looks on."""
    block = diagram.blocks[diagram.driven[signal][0]]
    return not block.role.drives and block.role not in ONLOOKERS
