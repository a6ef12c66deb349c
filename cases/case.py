"""A case: a diagram that reproduces a published experiment, and its numbers side by side."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from diagram.diagram import Diagram
    from diagram.simulation import Run
    from logs import LoopRecord


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
        """Simulate the case; keywords go to ``diagram.simulate`` (e.g. ``params={"valve.F_s": 1750.0}``)."""
        from diagram import simulate

        return simulate(self.build(), self.duration, every=self.every, **changes)

    def loop(self) -> "LoopRecord":
        """Simulate the case and return its loop; raise ``ValueError`` if no signals are plainly PV and OP.

        >>> from cases import find
        >>> find("ideal_high").loop().name
        'ideal_high'
        """
        log = self.run().log
        if "PV" not in log or "OP" not in log:
            raise ValueError(
                f"case '{self.name}' logs no signals PV and OP but {', '.join(log.names[:12])}, ...; run it and name "
                "them in Python: find(name).run().log.loop(sp=..., pv=..., op=...)"
            )
        return log.loop(name=self.name)
