"""What a record would have shown: from which size on an effect is no longer hidden."""

from dataclasses import dataclass

__all__ = ["Seen"]


@dataclass(frozen=True)
class Seen:
    """The least size of an effect at a place that this record would have shown: ``parameter``, ``size``,
    ``unit``; ``nominal`` is its size without the effect."""

    effect: str
    place: str
    parameter: str
    size: float
    unit: str
    nominal: float = 0.0

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        apart = f"{self.size - self.nominal:.2g}"
        size = f"{self.nominal:g} +- {apart}" if self.nominal else f"of more than {apart}"
        return f"{self.effect} at {self.place}, {self.parameter} {size}{unit}"
