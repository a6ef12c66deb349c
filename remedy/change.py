"""One thing that may have changed between two times of a loop, and all of them: as words and as JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.remedy.size import Size

__all__ = ["COUNTS", "Change", "Changes"]

COUNTS = {
    "controller_gain": 0.15, "controller_integral_time": 0.15, "stiction": 0.4, "process_gain": 0.25,
    "process_time_constant": 0.4, "dead_time": 0.3, "sensor_noise": 0.5, "disturbance": 0.6, "sensor_drift": 1.0,
}  # fmt: skip  # logarithms of ratios that count; of a level, what it moves over the spread about it
PLACES = {
    "controller_gain": "controller", "controller_integral_time": "controller", "stiction": "valve",
    "process_gain": "process", "process_time_constant": "process", "dead_time": "process", "sensor_noise": "sensor",
    "disturbance": "load", "sensor_drift": "sensor",
}  # fmt: skip
WORDS = {
    "controller_gain": "The controller's gain K_p", "controller_integral_time": "The controller's T_i",
    "stiction": "The dead travel S of the valve", "process_gain": "The gain K of the process",
    "process_time_constant": "The lags of the process", "dead_time": "The dead time",
    "sensor_noise": "The noise of the sensor", "disturbance": "The load",
    "sensor_drift": "What PV shows beside the flow of the valve, by the sensor or a load that stays,",
}  # fmt: skip


@dataclass(frozen=True)
class Change:
    """One thing that may have changed.

    earlier, later, ratio : with 90 % intervals;  nats : of the likelihood ratio;  probability : that it has changed
    changed : whether it is named;  ambiguous_with : effects that the records do not tell from it
    """

    effect: str
    earlier: Size
    later: Size
    ratio: Size
    nats: float
    probability: float
    changed: bool
    unit: str
    ambiguous_with: tuple[str, ...] = ()

    @property
    def place(self) -> str:
        """Where in the loop it is."""
        return PLACES[self.effect]

    def words(self) -> str:
        """It in a sentence."""
        other = f" It may be {' or '.join(WORDS[one].lower() for one in self.ambiguous_with)} as well."
        moved = f"{WORDS[self.effect]} went from {self.earlier} to {self.later} {self.unit}.".replace(" .", ".")
        return moved + (other if self.ambiguous_with else "")


@dataclass(frozen=True)
class Changes:
    """All that was compared, what changed most surely first; ``notes`` say what stays unknown.

    ``of_one`` : whether it is a loop without stick that one record is held against
    """

    compared: tuple[Change, ...]
    notes: tuple[str, ...]
    of_one: bool = False

    @property
    def changed(self) -> tuple[Change, ...]:
        """What has changed."""
        return tuple(one for one in self.compared if one.changed)

    @property
    def gap(self) -> bool:
        """Whether anything has."""
        return bool(self.changed)

    @property
    def words(self) -> tuple[str, ...]:
        """The answer in sentences."""
        if self.of_one:
            (stick,) = self.compared
            if not self.gap:
                return ("A loop without stick explains the record as well as one with it.",)
            return (f"{WORDS['stiction']} is {stick.later} {stick.unit}; without it the record is not explained.",)
        if not self.gap:
            return ("Nothing has changed beyond what the two records leave unsure.",)
        return tuple(one.words() for one in self.changed)

    def to_dict(self) -> dict[str, Any]:
        """The form of a gap report for JSON."""
        first = self.changed[0] if self.gap else None
        return {
            "gap": self.gap,
            "where": first
            and {
                "place": first.place, "probability": round(first.probability, 4),
                "confidence_set": sorted({first.place, *(PLACES[one] for one in first.ambiguous_with)}), "shares": {},
            },
            "causes": [
                {
                    "effect": one.effect, "place": one.place, "probability": round(one.probability, 4),
                    "ambiguous_with": list(one.ambiguous_with),
                    "parameters": {
                        "earlier": one.earlier.to_dict() | {"unit": one.unit},
                        "later": one.later.to_dict() | {"unit": one.unit}, "ratio": one.ratio.to_dict() | {"unit": "-"},
                    },
                }
                for one in self.changed
            ],
            "ranking": [
                {"effect": one.effect, "place": one.place, "probability": round(one.probability, 4)}
                for one in self.compared
            ],
            "hints": list(self.notes),
            "shrinkage": None,
        }  # fmt: skip
