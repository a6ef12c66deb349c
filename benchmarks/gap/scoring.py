"""Whether a diagnosis was right: names and places up to what the log can tell apart, shares with Wilson intervals."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.gap.runs import PLACES, Run, alike

CONFIDENT = 0.8
STEP_AT_START = {"valve_leak", "sensor_bias", "step_disturbance"}


def judged(run: Run, truth: Mapping[str, Any], report: Mapping[str, Any], seconds: float) -> dict[str, Any]:
    """Return what of a report is right.

    ``truth``: ``gap`` [noises] and ``effects`` name -> parameters, of the record; ``report`` as ``to_dict`` gives it.
    """
    names = [cause["effect"] for cause in report["causes"]]
    sets = [{cause["effect"], *cause["ambiguous_with"]} for cause in report["causes"]]
    places = set(report["where"]["confidence_set"]) if report["where"] else set()
    found: dict[str, Any] = {
        "key": run.key, "visible": truth["gap"], "gap": report["gap"], "names": names, "seconds": seconds,
        "sets": [sorted(s) for s in sets], "places": sorted(places),
        "probability": report["causes"][0]["probability"] if report["causes"] else None,
    }  # fmt: skip
    if len(run.effects) == 1:
        name = run.effects[0]
        group = _group(name, run.mv, run.setting)
        found["cause"] = bool(sets) and name in sets[0] and len(sets[0]) <= len(group)
        found["strict"] = bool(names) and names[0] == name
        wanted = {PLACES[one] for one in group}
        found["place"] = PLACES[name] in places and len(places) <= len(wanted)
        found["top3"] = bool(group & {rank["effect"] for rank in report["ranking"][:3]}) and report["gap"]
        found["error"] = _error(name, truth["effects"][name], report)
        found["shrinkage"] = report["shrinkage"] and report["shrinkage"]["fraction"]
    elif len(run.effects) > 1:
        found["both"] = all(any(name in s for s in sets) for name in run.effects)
    found["unknown"] = names == ["unknown"]
    confident = bool(names) and names[0] != "unknown" and (found["probability"] or 0.0) > CONFIDENT
    right = bool(run.effects) and any(set(run.effects) & s for s in sets)
    found["confident_wrong"] = confident and not right
    return found


def _group(name: str, mv: bool, setting: str) -> set[str]:
    """Return the equivalence class of an effect: offsets can also be a step before the first row."""
    group = set(alike(name, mv, setting))
    return group | STEP_AT_START if {"valve_leak", "sensor_bias"} <= group else group


def _error(name: str, truth: Mapping[str, float], report: Mapping[str, Any]) -> float | None:
    """Return the largest error of a parameter relative to the size of the effect; None if the name is not given."""
    cause = next((cause for cause in report["causes"] if cause["effect"] == name), None)
    if cause is None:
        return None
    errors = []
    for key, true in truth.items():
        if key in cause["parameters"] and key not in ("low", "phase", "offset_of_scan", "present"):
            size = abs(true - 1.0) if key in ("factor", "rangeability") else abs(true)
            errors.append(abs(cause["parameters"][key]["value"] - true) / max(size, 1e-12))
    return max(errors, default=None)


def scatter(p: float, n: int) -> float:
    """Return the mean of |k/n - p| for k of n right, each with probability p (De Moivre 1730).

    >>> round(scatter(0.5, 1), 6), round(scatter(0.9, 10), 6)
    (0.5, 0.069736)
    """
    m = min(math.floor(n * p), n - 1)
    return 2.0 * (m + 1) * math.comb(n, m + 1) * p ** (m + 1) * (1.0 - p) ** (n - m) / n


def share(rows: Sequence[Mapping[str, Any]], what: str) -> tuple[int, int]:
    """Return how many of the rows that have a figure have it true, and how many have it."""
    having = [row for row in rows if row.get(what) is not None]
    return sum(bool(row[what]) for row in having), len(having)
