"""What has changed between two times of one loop: its two fits beside each other.

    ln(later / earlier) of all pairs of the two populations, or of two normal values of a controller
    changed  0 is outside its 98 % interval, widened like all intervals, and the median is beyond what counts

Counts as a change: 15 % of a controller's value, 25 % of the process's gain, 50 % of its lags and of S, 65 % of noise,
and a factor of three of the load, which differs from day to day.  A stick that only one of the two times has is a
change of its own.
Not told: the bias or drift of a sensor, which a loop takes for its load, and a change that closes within a record.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.remedy.loop_fit import WIDER, LoopFit, Size, size_of

__all__ = ["Change", "Changes", "changes", "lacks"]

Floats = NDArray[np.float64]
TAIL = 1.0  # per cent on either side
COUNTS = {
    "controller_gain": 0.15, "controller_integral_time": 0.15, "stiction": 0.4, "process_gain": 0.25,
    "process_time_constant": 0.4, "sensor_noise": 0.5, "disturbance": 1.1,
}  # fmt: skip
PLACES = {
    "controller_gain": "controller", "controller_integral_time": "controller", "stiction": "valve",
    "process_gain": "process", "process_time_constant": "process", "sensor_noise": "sensor", "disturbance": "load",
}  # fmt: skip
WORDS = {
    "controller_gain": "The controller's gain K_p", "controller_integral_time": "The controller's T_i",
    "stiction": "The dead travel S of the valve", "process_gain": "The gain K of the process",
    "process_time_constant": "The lags of the process", "sensor_noise": "The noise of the sensor",
    "disturbance": "The load",
}  # fmt: skip


@dataclass(frozen=True)
class Change:
    """One thing that may have changed: later over earlier with its interval, and the odds that it did."""

    effect: str
    earlier: Size
    later: Size
    ratio: Size
    probability: float
    changed: bool
    unit: str

    @property
    def place(self) -> str:
        """Where in the loop it is."""
        return PLACES[self.effect]

    def words(self) -> str:
        """It in a sentence."""
        return f"{WORDS[self.effect]} went from {self.earlier} to {self.later} {self.unit}.".replace(" .", ".")


@dataclass(frozen=True)
class Changes:
    """All that was compared, what changed most surely first; ``notes`` say what cannot be told."""

    compared: tuple[Change, ...]
    notes: tuple[str, ...]

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
                "place": first.place, "probability": round(first.probability, 4), "confidence_set": [first.place],
                "shares": {},
            },
            "causes": [
                {
                    "effect": one.effect, "place": one.place, "probability": round(one.probability, 4),
                    "ambiguous_with": [],
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
            "shrinkage": None,
        }  # fmt: skip


def changes(earlier: LoopFit, later: LoopFit) -> Changes:
    """Return what has changed between two fits of one loop.

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> day = fit(sticky())
    >>> changes(day, day).gap
    False
    """
    pv, op = later.pv_unit, later.op_unit
    notes = ["A sensor that drifts looks like a load here, so it is not told."]
    found = [
        _controller("controller_gain", earlier, later, f"{op} per {pv or 'PV'}"),
        _controller("controller_integral_time", earlier, later, "s"),
        _stick(earlier, later),
    ]
    if earlier.best.integrating == later.best.integrating:
        found.append(_process("process_gain", earlier, later, lambda one: abs(one.K), f"{pv or 'PV'} per {op}"))
        found.append(_process("process_time_constant", earlier, later, _lags, "s"))
    else:
        notes.append("One record tells a process that integrates and the other one that does not: none is compared.")
    for effect, spread in (("sensor_noise", _noise), ("disturbance", _load)):
        a, b = (spread(one) for one in (earlier, later))
        found.append(_of_pairs(effect, Size(a, None, None), Size(b, None, None), np.array([b / max(a, 1e-300)]), pv))
    kept = [one for one in found if one is not None]
    return Changes(tuple(sorted(kept, key=lambda one: (-one.changed, -one.probability))), tuple(notes))


def lacks(found: LoopFit) -> Changes:
    """Return what a loop without stick lacks to tell this record: the stick, or nothing."""
    none = Size(0.0, 0.0, 0.0)
    probability = 1.0 / (1.0 + math.exp(-min(max(found.gain, -50.0), 50.0) + 10.0))
    ratio = Size(None, None, None, "none before")
    stick = Change("stiction", none, found.S, ratio, probability, found.sticks, found.op_unit)
    return Changes((stick,), (f"A loop with stick tells PV better than one without by {found.gain:.0f} nats.",))


def _lags(one: Any) -> float:
    return float(one.theta + one.tau_2 + (0.0 if one.integrating else one.tau))


def _noise(fit: LoopFit) -> float:
    """Spread of what differs from row to row of PV: third differences, which a slower signal does not pass."""
    return float(np.median([np.median(np.abs(np.diff(day.pv, 3))) / 3.0 for day in fit.days]))


def _load(fit: LoopFit) -> float:
    """Spread of what the likeliest loop leaves of PV."""
    return float(np.median([np.std(left) for left in fit.lefts[0]]))


def _controller(effect: str, earlier: LoopFit, later: LoopFit, unit: str) -> Change | None:
    key = "K_p" if effect == "controller_gain" else "T_i"
    sizes, logs, sd = [], [], 0.0
    for fit in (earlier, later):
        value = float(getattr(fit.controller, key))
        if not math.isfinite(value):
            return None
        low, high = fit.controller.spread(key)
        sizes.append(Size(value, low, high))
        logs.append(math.log(abs(value)))
        sd = math.hypot(sd, (high - low) / 3.29 / abs(value))
    z = np.linspace(-2.33, 2.33, 41)
    return _of_pairs(effect, sizes[0], sizes[1], np.exp(logs[1] - logs[0] + sd * z), unit)


def _stick(earlier: LoopFit, later: LoopFit) -> Change:
    if earlier.sticks and later.sticks:
        return _process("stiction", earlier, later, lambda one: one.S, later.op_unit)
    sticky = earlier if earlier.sticks else later
    other = later if earlier.sticks else earlier
    small = other.excluded if math.isfinite(other.excluded) else math.inf
    shown = float(np.percentile(sticky.each("S"), TAIL)) > small
    changed = sticky.sticks and (shown or other.gain < 0.25 * sticky.gain)
    return Change(
        "stiction", earlier.S, later.S, Size(None, None, None, "one of them has none"), 0.9 if changed else 0.1,
        changed, later.op_unit,
    )  # fmt: skip


def _process(effect: str, earlier: LoopFit, later: LoopFit, value: Any, unit: str) -> Change:
    a, b = (np.array([value(one) for one in fit.loops]) for fit in (earlier, later))
    return _of_pairs(effect, size_of(a), size_of(b), (b[:, None] / np.maximum(a[None, :], 1e-300)).ravel(), unit)


def _of_pairs(effect: str, earlier: Size, later: Size, ratios: Floats, unit: str) -> Change:
    """The change that the ratios (n,) of both times tell."""
    logs = np.log(np.maximum(ratios, 1e-300))
    middle, counts = float(np.median(logs)), COUNTS[effect]
    logs = middle + (1.0 if effect.startswith("controller") else WIDER) * (logs - middle)
    low, high = np.percentile(logs, [TAIL, 100.0 - TAIL])
    surely = bool(low > 0.0 or high < 0.0)
    probability = float(np.mean(np.abs(logs) > 0.5 * counts)) if len(logs) > 1 else float(abs(middle) > counts)
    value, least, most = (math.exp(min(x, 300.0)) for x in (middle, float(low), float(high)))
    ratio = Size(value, least, most)
    return Change(effect, earlier, later, ratio, probability, surely and abs(middle) > counts, unit)
