"""One thing that may have changed between two times of a loop, and all of them: as words and as JSON."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from stickslip.remedy.size import Size

__all__ = ["COUNTS", "Change", "Changes"]

_OF = {  # its place, the logarithm of a ratio that counts (of a level, its move over the spread about it), its words
    "controller_gain": ("controller", 0.15, "The controller's gain K_p"),
    "controller_integral_time": ("controller", 0.15, "The controller's T_i"),
    "stiction": ("valve", 0.4, "The dead travel S of the valve"),
    "process_gain": ("process", 0.25, "The gain K of the process"),
    "process_time_constant": ("process", 0.4, "The lags of the process"),
    "dead_time": ("process", 0.3, "The dead time"),
    "sensor_noise": ("sensor", 0.5, "The noise of the sensor"),
    "disturbance": ("load", 0.6, "The load"),
    "sensor_drift": ("sensor", 1.0, "What OP it takes to hold PV, by the sensor or a load that stays,"),
}
KNOWN = 30.0  # times the low end of a ratio's interval, above which its high end says nothing
PLACES = {effect: place for effect, (place, _, _) in _OF.items()}
COUNTS = {effect: counts for effect, (_, counts, _) in _OF.items()}
WORDS = {effect: words for effect, (_, _, words) in _OF.items()}


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

    @property
    def unsure(self) -> bool:
        """Whether the likeliest ratio is one that counts, though the records are not sure enough to name it."""
        ratio = self.ratio.value if self._known else None
        return not self.changed and ratio is not None and abs(math.log(ratio)) > COUNTS[self.effect]

    @property
    def _known(self) -> bool:
        """Whether the interval of the ratio says anything."""
        low, high = self.ratio.low, self.ratio.high
        return low is not None and high is not None and high < KNOWN * low

    def row(self) -> list[str]:
        """It in a table: what, unit, earlier, later, ratio, and whether it has changed."""
        ratio = str(self.ratio) if self._known else ""
        said = "yes" if self.changed else "unsure" if self.unsure else "no"
        return [self.effect.replace("_", " "), self.unit, str(self.earlier), str(self.later), ratio, said]

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
            said = "Nothing has changed beyond what the two records leave unsure."
            may = next((one for one in self.compared if one.unsure), None)
            more = f" {WORDS[may.effect]} may have: {may.ratio} times what it was." if may else ""
            return (said + more,)
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
