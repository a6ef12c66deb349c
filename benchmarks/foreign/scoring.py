"""When an answer is right, and the figures: shares with their count and interval (Wilson, 90 %).

A record whose effect leaves no trace, such as a limit that is never reached, is left out and counted.
"""

import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.detect.published import wilson

from benchmarks.foreign.answer import Answer
from benchmarks.report import Figures

CLASSES = (  # of a single loop of which OP, PV and SP are logged (design/effects.md)
    ("valve_gain", "process_gain", "sensor_span"),
    ("positioner_lag", "second_lag", "sensor_lag"),
    ("valve_leak", "sensor_bias", "step_disturbance"),
)
AT = {
    "valve_gain": "valve", "process_gain": "process", "sensor_span": "sensor", "positioner_lag": "valve",
    "second_lag": "process", "sensor_lag": "sensor", "valve_leak": "valve", "sensor_bias": "sensor",
    "step_disturbance": "feed",
}  # fmt: skip
CONFIDENT = 0.8
SHOWS = 0.05  # what changes no tag by this share of what chance does leaves no trace
Alike = Mapping[str, tuple[tuple[str, str], ...]]

NOTES = {
    "plants": "plants that are wired and have a record (required: at least 12)",
    "effect_records": "records with an effect that leaves a trace (required: at least 300)",
    "none_records": "records without one (required: at least 150)",
    "outside_records": "records with what no catalogue has (required: at least 100)",
    "no_trace": "records left out, as their effect leaves no trace",
    "place": "right place, up to what leaves the same log (required: at least 0.90)",
    "cause": "right cause, up to what leaves the same log (required: at least 0.80)",
    "place_strict": "right place, first choice as it is",
    "cause_strict": "right cause, first choice as it is",
    "named_set": "effects that an answer names, on average",
    "missed": "records with an effect that are called free of a gap",
    "false_alarms": "records without an effect that are said to have a gap (required: at most 0.02)",
    "false_alarms_stated_right": "of those whose noise and load are of the stated size",
    "unknown": "of what no catalogue has, said to be a gap without a name (required: at least 0.80)",
    "unknown_at_place": "of what no catalogue has, unknown and at the right place (required: at least 0.75)",
    "confident_wrong": "of all records, a wrong name at a probability of 0.8 or more (required: at most 0.02)",
    "crashes": "records that end in an exception (required: at most 0)",
    "cpu_median": "processor time of a diagnosis, median [s]",
    "cpu_p90": "processor time of a diagnosis, ninth decile [s]",
}


def same_log(effect: str, place: str, alike: Alike | None) -> set[tuple[str, str]]:
    """Return what leaves the log of an effect, by name and place, itself among them.

    >>> sorted(same_log("sensor_bias", "sensor", None))
    [('sensor_bias', 'sensor'), ('step_disturbance', 'feed'), ('valve_leak', 'valve')]
    """
    if alike is not None:
        return {(effect, place), *alike.get(effect, ())}
    return {(effect, place)} | {(one, AT[one]) for group in CLASSES if effect in group for one in group}


def scored(group: str, effect: str, place: str, answer: Answer | None, alike: Alike | None) -> dict[str, Any]:
    """Return what is right of an answer, None of which there is no question; a crash is right in nothing."""
    said = answer or Answer(False)
    name = said.causes[0] if said.causes else None
    found = (name.effect, name.place) if name else ("", "")
    inside, outside = group == "effect", group == "outside"
    held = same_log(effect, place, alike)
    right = inside and found in held
    at = said.gap and (said.place == place or right)
    return {
        "gap": said.gap,
        "right_cause": right if inside else None,
        "right_cause_strict": found == (effect, place) if inside else None,
        "right_place": at if inside else None,
        "right_place_strict": (said.gap and said.place == place) if inside or outside else None,
        "unknown": said.unknown if outside else None,
        "unknown_at_place": (said.unknown and said.place == place) if outside else None,
        "unknown_holds_place": (said.unknown and place in said.places) if outside else None,
        "confident_wrong": name is not None and name.probability >= CONFIDENT and not right,
        "named_set": 1 + len(name.alike) if name else None,
    }


def figures(rows: Sequence[Mapping[str, Any]]) -> tuple[Figures, dict[str, str]]:
    """Return the figures, and each share in words: right of all, and its interval."""
    seen = [row for row in rows if row["group"] == "none" or row["change"] >= SHOWS]
    inside, none, outside = ([row for row in seen if row["group"] == g] for g in ("effect", "none", "outside"))
    stated = [row for row in none if row["noise_factor"] == 1.0 and row["load_factor"] == 1.0]
    shares = {
        "place": [row["right_place"] for row in inside],
        "cause": [row["right_cause"] for row in inside],
        "place_strict": [row["right_place_strict"] for row in inside],
        "cause_strict": [row["right_cause_strict"] for row in inside],
        "missed": [not row["gap"] for row in inside],
        "false_alarms": [row["gap"] for row in none],
        "false_alarms_stated_right": [row["gap"] for row in stated],
        "unknown": [row["unknown"] for row in outside],
        "unknown_at_place": [row["unknown_at_place"] for row in outside],
        "confident_wrong": [row["confident_wrong"] for row in seen],
    }
    cpu = [row["cpu"] for row in seen]
    sets = [row["named_set"] for row in inside if row["named_set"] is not None]
    counts: Figures = {
        "plants": len({row["plant"] for row in seen}), "effect_records": len(inside), "none_records": len(none),
        "outside_records": len(outside), "no_trace": len(rows) - len(seen),
    }  # fmt: skip
    rest: Figures = {
        "crashes": sum(bool(row["crash"]) for row in seen),
        "named_set": statistics.fmean(sets) if sets else None,
        "cpu_median": statistics.median(cpu) if cpu else None,
        "cpu_p90": statistics.quantiles(cpu, n=10)[-1] if len(cpu) > 1 else None,
    }
    words = {name: in_words(hits) for name, hits in shares.items() if hits}
    return counts | {name: sum(hits) / len(hits) if hits else None for name, hits in shares.items()} | rest, words


def in_words(hits: Sequence[bool]) -> str:
    """Return a share as it is printed.

    >>> in_words([True] * 9 + [False])
    '9 of 10, 0.90 (0.65 to 0.98)'
    """
    low, high = wilson(sum(hits), len(hits))
    return f"{sum(hits)} of {len(hits)}, {sum(hits) / len(hits):.2f} ({low:.2f} to {high:.2f})"


def by_plant(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return a line for each plant: right places, causes, alarms, unknowns, crashes; counts of all."""
    out = []
    for name in dict.fromkeys(row["plant"] for row in rows):
        _, words = figures([row for row in rows if row["plant"] == name])
        shown = [key for key in ("place", "cause", "false_alarms", "unknown") if key in words]
        parts = [f"{key} {words[key].split(',')[0]}" for key in shown]
        crashes = sum(bool(row["crash"]) for row in rows if row["plant"] == name)
        out.append(f"{name:18} " + "; ".join([*parts, f"crashes {crashes}"]))
    return out
