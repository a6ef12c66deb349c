"""What is said of one cause, or of two: effects, places, sizes, and what cannot be told apart from each."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from stickslip.gap.answers.report import Cause, Size, listed
from stickslip.gap.insertion.effect import Effect


class NamedCause(NamedTuple):
    """An effect that is named at a place, its ``sizes``, and the names of ``others`` not told apart from it."""

    effect: Effect
    place: str
    sizes: Mapping[str, Size]
    others: tuple[str, ...]

    def __str__(self) -> str:
        sizes = ", ".join(f"{name} {size}" for name, size in self.sizes.items())
        return f"{self.effect.name} at {self.place}, {sizes}"

    def stated(self, probability: float) -> Cause:
        """Return the cause as a report states it."""
        return Cause(self.effect.name, self.place, probability, self.others, self.sizes)


def named_cause(same: Sequence[tuple[Effect, str]], sizes: Mapping[str, Size]) -> NamedCause:
    """Return what is said of effects at places that are not told apart, the likeliest first, which has these sizes."""
    effect, place = same[0]
    others = tuple(dict.fromkeys(one.name for one, _ in same if one.name != effect.name))
    return NamedCause(effect, place, sizes, others)


def said_of(causes: Sequence[NamedCause], places: Sequence[str]) -> list[str]:
    """Return one cause, or two, in words; ``places`` that the log does not tell apart."""
    if len(causes) == 1:
        words = [f"There is a gap. Place: {listed(places)}. Cause: {causes[0]}."]
    else:
        words = [f"There is a gap with two causes: {'; and '.join(map(str, causes))}."]
    words += [
        f"From these signals {one.effect.name} cannot be told apart from {listed(one.others)}."
        for one in causes if one.others
    ]  # fmt: skip
    return words
