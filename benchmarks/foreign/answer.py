"""What a diagnosis answered, in few words: any tool that gives these can be scored."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

UNKNOWN = "unknown"


@dataclass(frozen=True)
class Cause:
    """An effect by name, the block where it is, how probable that is, and effects that leave the same log."""

    effect: str
    place: str
    probability: float
    alike: tuple[str, ...] = ()


@dataclass(frozen=True)
class Answer:
    """``gap``: whether there is one; ``place``: where it lies, "" without one; ``causes``: first choice first.

    Without causes a gap is unknown.  ``places``: all blocks that the answer holds possible.
    """

    gap: bool
    place: str = ""
    causes: tuple[Cause, ...] = ()
    places: tuple[str, ...] = ()

    @property
    def unknown(self) -> bool:
        """Whether there is a gap that it gives no name."""
        return self.gap and not self.causes

    @classmethod
    def of(cls, report: Mapping[str, Any], places: Mapping[str, str]) -> "Answer":
        """Read what ``stickslip gap --json`` says; ``places``: block of the model -> block of the data sheet.

        >>> said = {"effect": "unknown", "place": "stem", "probability": 0.9, "ambiguous_with": []}
        >>> report = {"gap": True, "where": {"place": "stem", "confidence_set": ["stem"]}, "causes": [said]}
        >>> Answer.of(report, {"stem": "valve"})
        Answer(gap=True, place='valve', causes=(), places=('valve',))
        """
        if not report["gap"]:
            return cls(False)

        def at(place: str) -> str:
            return places.get(place, place)

        causes = tuple(
            Cause(one["effect"], at(one["place"]), one["probability"], tuple(one["ambiguous_with"]))
            for one in report["causes"]
            if one["effect"] != UNKNOWN
        )
        where = report["where"]
        return cls(True, at(where["place"]), causes, tuple(dict.fromkeys(map(at, where["confidence_set"]))))
