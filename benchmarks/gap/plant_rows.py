"""What diagnoses of the plant's records come to: made one after the other, kept, judged."""

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.gap.plant import MODELS, ROUNDING, PlantRun
from benchmarks.gap.scoring import CONFIDENT

ALIKE = ({"real_gas", "gas_temperature"},)  # one product of both is in the model
VISIBLE = 0.5  # largest difference to the log without the effect, root mean square in steps of rounding


def plant_row(run: PlantRun) -> dict[str, Any]:
    """Return what the diagnosis of one run came to; one whose plant stops early leaves no record to diagnose."""
    from stickslip.gap import diagnose

    try:
        log = run.made()
    except RuntimeError as stopped:
        nothing = {"gap": False, "causes": [], "where": None}
        return plant_judged(run, nothing) | {"seconds": 0.0, "cpu": 0.0, "visible": 0.0, "stopped": str(stopped)}
    begin, used = time.perf_counter(), time.process_time()
    report = diagnose(MODELS[run.model][0](), log, progress=False)
    found = plant_judged(run, report.to_dict())
    found |= {"seconds": time.perf_counter() - begin, "cpu": time.process_time() - used}
    found |= {
        "probability": report.causes[0].probability if report.causes else None,
        "kind": report.evidence.kind if report.evidence else None,
    }
    if run.effect:
        clean = run.made(clean=True)
        steps = {s: ROUNDING[s[0]] for s in log.names if ROUNDING[s[0]] > 0.0}
        found["visible"] = max(float(np.sqrt(np.mean((log[s] - clean[s]) ** 2))) / step for s, step in steps.items())
    return found


def plant_judged(run: PlantRun, report: Mapping[str, Any]) -> dict[str, Any]:
    """Return what of a report on a run is right.

    >>> cause = {"effect": "real_gas", "ambiguous_with": ["gas_temperature"], "probability": 0.9}
    >>> report = {"gap": True, "causes": [cause], "where": {"confidence_set": ["S1"]}}
    >>> found = plant_judged(PlantRun("full_plant", "real_gas", "S1"), report)
    >>> found["cause"], found["place"]
    (True, True)
    """
    sets = [{cause["effect"], *cause["ambiguous_with"]} for cause in report["causes"]]
    places = set(report["where"]["confidence_set"]) if report["where"] else set()
    names = [cause["effect"] for cause in report["causes"]]
    group: set[str] = next((one for one in ALIKE if run.effect in one), {run.effect})
    right = bool(sets) and run.effect in sets[0] and sets[0] <= group
    sure = bool(names) and names[0] != "unknown" and report["causes"][0]["probability"] > CONFIDENT
    return {
        "key": run.key, "model": run.model, "effect": run.effect, "gap": report["gap"], "names": names,
        "sets": [sorted(one) for one in sets], "places": sorted(places), "cause": right,
        "place": places == {run.place}, "confident_wrong": bool(run.effect) and sure and not right,
    }  # fmt: skip


def plant_figures(found: Sequence[Mapping[str, Any]]) -> dict[str, tuple[int, int]]:
    """Return figure -> (hits, of): place and cause of the full plant and of the section, alarms without a gap."""
    out = {}
    for model, word in (("full_plant", "plant"), ("separator_section", "section")):
        here = [row for row in found if row["model"] == model]
        seen = [row for row in here if row["effect"] and row["visible"] > VISIBLE]
        none = [row for row in here if not row["effect"]]
        for what in ("place", "cause", "confident_wrong"):
            out[f"{word}_{what}"] = sum(bool(row[what]) for row in seen), len(seen)
        out[f"{word}_false_alarm"] = sum(bool(row["gap"]) for row in none), len(none)
    return out
