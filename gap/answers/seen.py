"""What a record would have shown: from which size on an effect is no longer hidden."""

from dataclasses import dataclass

__all__ = ["Seen"]


@dataclass(frozen=True)
class Seen:
    """The least size of an effect at a place that this record would have shown: ``parameter``, ``size``, ``unit``."""

    effect: str
    place: str
    parameter: str
    size: float
    unit: str

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.effect} at {self.place} ({self.parameter} {self.size:.{7 if unit == '' else 2}g}{unit})"
