"""What the rows of the gap's benchmark come to: each figure that is required, shares with count and interval."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.detect.published import wilson

from benchmarks.gap.oracle import relative, right
from benchmarks.gap.plant_rows import plant_figures
from benchmarks.gap.runs import VISIBLE
from benchmarks.gap.scoring import scatter, share
from benchmarks.gap.settings import SETTINGS
from benchmarks.gap.visible import visible
from benchmarks.report import Figures

LARGE = 0.15  # nats a row
NOTES = {
    "place": "place right up to its class, ideal flow loop, typical and gross (required: at least 0.97)",
    "place_with_mv": "the same with MV logged (required: at least 0.97)",
    "cause_top1": "cause right up to its class, typical and gross (required: at least 0.97)",
    "cause_top3": "cause among the first three (required: at least 0.98)",
    "cause_strict": "cause named first, classes not counted",
    "set_size": "mean number of effects in the named set",
    "cause_just_visible": "cause right, just visible (required: at least 0.92)",
    "false_alarm": "alarms on records without a gap (required: at most 0.004)",
    "unknown_recall": "effects outside the catalogue called unknown (required: at least 0.9)",
    "confident_wrong": "wrong names above 0.8 on effects outside the catalogue (required: at most 0.02)",
    "unknown_just_visible": "effects outside the catalogue called unknown, just visible",
    "confident_wrong_just_visible": "wrong names above 0.8 on these",
    "pairs_both": "pairs with both effects named (required: at least 0.8)",
    "shrinkage_median": "held-out shrinkage of right names relative to the true effect (required: at least 0.98)",
    "shrinkage_p10": "its tenth percentile (required: at least 0.9)",
    "parameter_error": "median error relative to the effect, without stiction (required: at most 0.01)",
    "parameter_error_p90": "its 90th percentile (required: at most 0.05)",
    "stiction_error": "the same for stiction (required: at most 0.03)",
    "stiction_error_p90": "its 90th percentile (required: at most 0.15)",
    "calibration_error": "stated probability less share of right names (required: at most 0.05)",
    "calibration_floor": "what it would be on so few answers if every probability were true",
    "coarse_cause": "cause right, log rounded to 0.001 and 0.1 % (required: at least 0.92)",
    "site_place": "place right, site loop, typical and gross (required: at least 0.9)",
    "site_cause": "cause right, site loop, typical and gross (required: at least 0.9)",
    "site_cause_typical": "cause right, site loop, typical (required: at least 0.9)",
    "site_place_gross": "place right, site loop, gross (required: at least 0.97)",
    "site_cause_gross": "cause right, site loop, gross (required: at least 0.97)",
    "site_unknown_typical": "unknown recognised, site loop, typical (required: at least 0.75)",
    "site_unknown_gross": "unknown recognised, site loop, gross (required: at least 0.95)",
    "site_stiction_error": "median largest error of S and J, site loop (required: at most 0.05 of S, 0.2 of J)",
    "site_shrinkage": "median held-out shrinkage of right names, gap above 0.15 nat a row (required: at least 0.9)",
    "site_unknown": "unknown recognised, site loop (required: at least 0.75)",
    "site_confident_wrong": "wrong names above 0.8, site loop (required: at most 0.03)",
    "site_unknown_just_visible": "unknown recognised, site loop, just visible",
    "site_false_alarm": "alarms, site loop (required: at most 0.02)",
    "general_place": "place right: second order, level, cascade (required: at least 0.85)",
    "general_cause": "cause right: second order, level, cascade (required: at least 0.8)",
    "general_place_told": "the same with places that an oracle of physics cannot tell from the true one either",
    "general_cause_told": "cause right, or a set whose names an oracle of physics cannot tell from the truth either",
    "invisible": "runs left out: the effect leaves no trace",
    "hidden": "of these, such whose trace tolerances or the load hide, by an oracle of physics",
    "plant_place": "place right, full plant (required: at least 0.9, on at least 60 records)",
    "plant_cause": "cause right, full plant (required: at least 0.8)",
    "plant_confident_wrong": "wrong names above 0.8, full plant",
    "plant_false_alarm": "alarms, full plant",
    "section_place": "place right, separator section",
    "section_cause": "cause right, separator section",
    "section_confident_wrong": "wrong names above 0.8, separator section",
    "section_false_alarm": "alarms, separator section",
    "free_run_place": "baseline: place of the signal with the largest free-run error",
    "parameters_only": "baseline: median held-out shrinkage with other parameters and no effect, ideal flow loop",
    "flexible_residual": "baseline: median held-out shrinkage with a flexible residual, ideal flow loop",
    "site_s": "median seconds of one diagnosis of the site loop (required: at most 4)",
    "loop_s": "median seconds of one diagnosis, floor known (required: at most 5)",
    "first_s": "seconds of the first diagnosis of a model (required: at most 90)",
}


def figures(found: Sequence[dict[str, Any]], plant: Sequence[dict[str, Any]] = ()) -> tuple[Figures, dict[str, str]]:
    """Return the figures of the issue, and for each share its count and interval in words; ``plant``: its rows."""
    single = [r for r in found if len(r["effects"]) == 1]
    seen = [r for r in single if visible(r)]
    counts: dict[str, str] = {}
    out: Figures = {}

    def add(name: str, some: list[dict[str, Any]], what: str) -> None:
        counted(name, *share(some, what))

    def counted(name: str, hits: int, of: int) -> None:
        out[name] = hits / of if of else None
        low, high = wilson(hits, of, z=1.96) if of else (0.0, 1.0)
        counts[name] = f"{hits} of {of}, {low:.3f} to {high:.3f}" if of else "none"

    def at(setting: str, *severities: str, mv: bool = False) -> list[dict[str, Any]]:
        return [r for r in seen if r["setting"] == setting and r["severity"] in severities and r["mv"] == mv]

    far, general = ("typical", "gross"), ("second_order", "level", "cascade")
    add("place", at("ideal", *far), "place")
    add("place_with_mv", at("ideal", *far, mv=True), "place")
    add("cause_top1", at("ideal", *far), "cause")
    add("cause_top3", at("ideal", *far), "top3")
    add("cause_strict", at("ideal", *far), "strict")
    out["set_size"] = _mean([len(r["sets"][0]) for r in at("ideal", *far) if r["sets"]])
    add("cause_just_visible", at("ideal", "just visible"), "cause")
    add("false_alarm", _none(found, "ideal"), "gap")
    add("unknown_recall", _outside(found, "ideal", *far), "unknown")
    add("confident_wrong", _outside(found, "ideal", *far), "confident_wrong")
    add("unknown_just_visible", _outside(found, "ideal", "just visible"), "unknown")
    add("confident_wrong_just_visible", _outside(found, "ideal", "just visible"), "confident_wrong")
    add("pairs_both", [r for r in found if len(r["effects"]) > 1], "both")
    shrunk = [part for r in at("ideal", *far) if r["cause"] and (part := relative(r)) is not None]
    out["shrinkage_median"], out["shrinkage_p10"] = _quantile(shrunk, 0.5), _quantile(shrunk, 0.1)
    for name, sticky in (("parameter_error", False), ("stiction_error", True)):
        errors = [
            r["error"] for r in at("ideal", *far)
            if r["error"] is not None and r["cause"] and (r["effects"] == ["stiction"]) == sticky
        ]  # fmt: skip
        out[name], out[f"{name}_p90"] = _quantile(errors, 0.5), _quantile(errors, 0.9)
    ideal = [r for r in found if r["setting"] == "ideal" and not r["mv"]]
    out["calibration_error"], out["calibration_floor"] = _calibration(ideal)
    add("coarse_cause", at("coarse", *far), "cause")
    add("site_place", at("site", *far), "place")
    add("site_cause", at("site", *far), "cause")
    add("site_cause_typical", at("site", "typical"), "cause")
    add("site_place_gross", at("site", "gross"), "place")
    add("site_cause_gross", at("site", "gross"), "cause")
    for severity in far:
        add(f"site_unknown_{severity}", _outside(found, "site", severity), "unknown")
    errors = [r["error"] for r in at("site", *far) if r["effects"] == ["stiction"] and r["error"] is not None]
    out["site_stiction_error"] = _quantile(errors, 0.5)
    out["site_shrinkage"] = _quantile([r["shrinkage"] for r in at("site", *far) if r["cause"] and _large(r)], 0.5)
    add("site_unknown", _outside(found, "site", *far), "unknown")
    add("site_confident_wrong", _outside(found, "site", *far), "confident_wrong")
    add("site_unknown_just_visible", _outside(found, "site", "just visible"), "unknown")
    add("site_false_alarm", _none(found, "site"), "gap")
    wide = [r for r in seen if r["setting"] in general]
    add("general_place", wide, "place")
    add("general_cause", wide, "cause")
    add("general_place_told", [r | {"place": r["place"] or r.get("told_place")} for r in wide], "place")
    add("general_cause_told", [r | {"cause": r["cause"] or r.get("told_apart")} for r in wide], "cause")
    for name, (hits, of) in plant_figures(plant).items():
        counted(name, hits, of)
    out["invisible"] = float(len(single) - len(seen))
    out["hidden"] = float(sum(r["visible"] > VISIBLE and not visible(r) for r in single))
    add("free_run_place", [r | {"hit": r["free_run_place"] in r["places"]} for r in seen if r["cause"]], "hit")
    for name in ("parameters_only", "flexible_residual"):
        out[name] = _quantile([r[name] for r in at("ideal", *far) if r.get(name) is not None], 0.5)
    out["site_s"] = _quantile([r["seconds"] for r in found if r["setting"] == "site" and not r["first"]], 0.5)
    out["loop_s"] = _quantile([r["seconds"] for r in found if r["setting"] == "ideal" and not r["first"]], 0.5)
    out["first_s"] = max((r["seconds"] for r in found if r["first"]), default=None)
    return out, counts


def _calibration(found: Sequence[dict[str, Any]]) -> tuple[float | None, float | None]:
    """Return the mean difference between stated probability and share of right answers, by the kind of answer.

    And what it would be on as many answers of each kind if every probability were true.
    """
    stated = [r for r in found if r["probability"] is not None and (r["visible"] > VISIBLE or not r["effects"])]
    kinds: dict[float, list[bool]] = {}
    for r in stated:
        kinds.setdefault(r["probability"], []).append(right(r))
    if not stated:
        return None, None
    error = sum(abs(p - _mean(hits)) * len(hits) for p, hits in kinds.items()) / len(stated)
    floor = sum(scatter(p, len(hits)) * len(hits) for p, hits in kinds.items()) / len(stated)
    return error, floor


def _none(found: Sequence[dict[str, Any]], setting: str) -> list[dict[str, Any]]:
    return [r for r in found if r["setting"] == setting and not r["effects"] and not r["outside"]]


def _outside(found: Sequence[dict[str, Any]], setting: str, *severities: str) -> list[dict[str, Any]]:
    here = [r for r in found if r["setting"] == setting and r["outside"] and r["visible"] > VISIBLE]
    return [r for r in here if r["severity"] in severities]


def _large(row: dict[str, Any]) -> bool:
    """Return whether a gap is so large that the loss of held-out rows must shrink with it."""
    loop = SETTINGS[row["setting"]]
    rows = 3600.0 * loop.hours / loop.every
    return row["evidence"] is not None and row["evidence"]["gap"] > LARGE * rows and row["shrinkage"] is not None


def _mean(values: Sequence[float | bool]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _quantile(values: Sequence[float] | NDArray[np.float64], q: float) -> float | None:
    return float(np.quantile(values, q)) if len(values) else None
