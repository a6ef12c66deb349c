"""A case: a diagram that reproduces a published experiment, and its numbers side by side."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram
    from stickslip.diagram.simulation import Run
    from stickslip.logs import LoopRecord


@dataclass(frozen=True)
class Number:
    """One quantity three times: as published, from theory, and as reproduced here.

    ``published`` and ``analytic`` are None where nobody printed or derived one.  ``spread`` is the standard
    deviation of the reproduced value where it is a mean.  ``note`` explains any difference in a sentence.
    """

    quantity: str
    unit: str
    published: float | None
    analytic: float | None
    reproduced: float
    spread: float | None = None
    source: str = ""
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return the number as plain values for JSON."""
        return dict(self.__dict__)


@dataclass(frozen=True)
class Case:
    """A named case: what it shows, how to build and run it, and how to compute its numbers.

    ``numbers`` takes no argument because some numbers need other starts or parameters than the plain run.
    ``signals`` are those its picture shows (default: all, if they fit).
    """

    name: str
    title: str
    about: str
    build: Callable[[], "Diagram"]
    duration: float
    every: float
    numbers: Callable[[], Sequence[Number]]
    signals: tuple[str, ...] = ()

    def run(self, **changes: Any) -> "Run":
        """Simulate the case; keywords go to ``stickslip.diagram.simulate`` (e.g. ``params={"valve.F_s": 1750.0}``)."""
        from stickslip.diagram import simulate

        return simulate(self.build(), self.duration, every=self.every, **changes)

    def loop(self, tag: str = "") -> "LoopRecord":
        """Simulate the case and return its loop, of several the one of the controller ``tag``.

        Raises ``ValueError`` if there are several and none is named, or none of that name.

        >>> from stickslip.cases import find
        >>> find("ideal_high").loop().name
        'ideal_high'
        """
        records = self.loop_records()
        tags = [record.name.removeprefix(f"{self.name} ") for record in records]
        if not tag and len(records) == 1:
            return records[0]
        if tag not in tags:
            asked = f"no loop '{tag}'" if tag else f"{len(tags)} loops"
            raise ValueError(f"case '{self.name}' has {asked}; name one of {', '.join(tags)}: loop(tag)")
        return records[tags.index(tag)]

    def loop_records(self) -> "tuple[LoopRecord, ...]":
        """Simulate the case and return all its loops; the one loop of a case has the case's name.

        Where there are several, the controller's is added; ``ValueError`` if the case has none.
        """
        log = self.run().log
        records = log.loop_records() if log.loops or {"PV", "OP"} <= set(log.names) else ()
        if not records:
            raise ValueError(f"case '{self.name}' has no controller, hence no loop to judge")
        if len(records) == 1:
            return (replace(records[0], name=self.name),)
        return tuple(replace(record, name=f"{self.name} {record.name}") for record in records)
