"""The result of an oscillation detector: does the loop oscillate, how fast, how regularly, how much."""

from dataclasses import dataclass
from typing import NamedTuple

from stickslip.detect.card import Card

REGULARITY_MAX = 999.0  # a perfectly regular wave has no spread; a finite stand-in keeps JSON happy

# What most oscillation detectors have in common; each puts its own facts in.
GATE_CARD = Card(
    "", "", "", ("SP", "PV"), (), "", (0.0, REGULARITY_MAX), ("self_regulating", "integrating"), "no", kind="gate",
)  # fmt: skip


class Stretch(NamedTuple):
    """Part of a record with one period: from ``start`` to ``end`` [s], ``period`` [s]."""

    start: float
    end: float
    period: float


@dataclass(frozen=True)
class Gate:
    """Result of an oscillation test.

    period : period of the oscillation [s]; None when there is none to speak of
    regularity : mean / (3 std) of the crossing intervals [-], at most 999; above 1 is regular
    amplitude : half the peak-to-peak of the equivalent sine, sqrt(2) std [unit of the signal]
    cycles : cycles in the record, duration / period
    reason : one sentence with the numbers
    stretches : where it oscillates and how fast, in order of time; several when the period drifts, empty when the test
        does not say where

    >>> Gate.none("No regular crossings.", amplitude=1.2).oscillating
    False
    """

    oscillating: bool
    period: float | None
    regularity: float
    amplitude: float
    cycles: float
    reason: str
    stretches: tuple[Stretch, ...] = ()

    @classmethod
    def none(cls, reason: str, amplitude: float = 0.0) -> "Gate":
        """Return the answer of a test that found no oscillation to speak of, and why; ``amplitude`` of the signal."""
        return cls(False, None, 0.0, amplitude, 0.0, reason)
