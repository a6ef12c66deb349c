"""How well the gap between a model and a log is diagnosed, on records of a program that shares no code with it.

Resumable: each diagnosis is one line of a file in ``--folder``; what is there is not made again.  Records come in an
order of which every beginning holds each kind by its share.  ``--part 1/2`` and ``--part 2/2`` make every other record,
for two processes at once; without ``--part`` all rows in the folder are read.  ``--bare`` leaves out the two baselines
that refit and the oracle of what shows: then no record is left out but one that leaves no trace.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.gap.baselines import free_run_place, shrinkages
from benchmarks.gap.generator import FAMILIES
from benchmarks.gap.models import model
from benchmarks.gap.oracle import possible, relative, restated, right
from benchmarks.gap.plant import runs as plant_runs
from benchmarks.gap.plant_rows import plant_figures, plant_row
from benchmarks.gap.runs import VISIBLE, Run, benchmark
from benchmarks.gap.scoring import judged, scatter, share, wilson
from benchmarks.gap.visible import traced, visible
from benchmarks.report import Figures, publish
from benchmarks.resumed import in_turn, part_file, resumed

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
    "site_unknown": "unknown recognised, site loop (required: at least 0.75)",
    "site_confident_wrong": "wrong names above 0.8, site loop (required: at most 0.03)",
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
    "loop_s": "median seconds of one diagnosis, floor known (required: at most 5)",
    "first_s": "seconds of the first diagnosis of a model (required: at most 90)",
}


def rows(
    runs: Sequence[Run], folder: Path, seconds: float, part: tuple[int, int] = (0, 0), bare: bool = False
) -> Iterator[dict[str, Any]]:
    """Return what each run came to, those made earlier and kept in the folder among them."""
    first: set[str] = set()
    also = sorted(folder.glob("diagnoses*.jsonl"))
    made = resumed(runs, lambda run: _row(run, first, bare), part_file(folder, "diagnoses", part), seconds, also)
    return map(restated, made)


def _row(run: Run, first: set[str], bare: bool) -> dict[str, Any]:
    from gap import diagnose
    from logs import Log

    record = run.made()
    signals = {s: v for s, v in record.signals.items() if s != "time" and (run.mv or s != "MV")}
    begin, used = time.perf_counter(), time.process_time()
    found = diagnose(model(run.setting), Log(record.signals["time"], signals), limits=False, progress=False)
    seconds, cpu = time.perf_counter() - begin, time.process_time() - used
    report = found.to_dict()
    truth = {"gap": record.gap, "effects": {k: dict(v) for k, v in record.effects.items()}}
    row = judged(run, truth, report, seconds) | free_run_place(record)
    if run.setting == "ideal" and len(run.effects) == 1 and not bare:
        row |= shrinkages(model(run.setting), Log(record.signals["time"], signals))
    row |= {"oracle": possible(model(run.setting), Log(record.signals["time"], signals), truth["effects"])}
    row |= {"evidence": found.evidence and asdict(found.evidence), "cpu": cpu}
    row |= {} if bare else traced(record, row)
    row |= {"setting": run.setting, "severity": run.severity, "mv": run.mv, "effects": list(run.effects),
            "outside": run.outside, "first": run.setting not in first, "family": run.family}  # fmt: skip
    first.add(run.setting)
    return row


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
        low, high = wilson(hits, of)
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
    add("unknown_recall", _outside(found, "ideal"), "unknown")
    add("confident_wrong", _outside(found, "ideal"), "confident_wrong")
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
    add("site_unknown", _outside(found, "site"), "unknown")
    add("site_confident_wrong", _outside(found, "site"), "confident_wrong")
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


def _outside(found: Sequence[dict[str, Any]], setting: str) -> list[dict[str, Any]]:
    return [r for r in found if r["setting"] == setting and r["outside"] and r["visible"] > VISIBLE]


def _mean(values: Sequence[float | bool]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _quantile(values: Sequence[float] | NDArray[np.float64], q: float) -> float | None:
    return float(np.quantile(values, q)) if len(values) else None


def _part(text: str) -> tuple[int, int]:
    k, _, of = text.partition("/")
    if not (k.isdigit() and of.isdigit() and 1 <= int(k) <= int(of)):
        raise argparse.ArgumentTypeError(f"{text!r} is no part: give K/N with K from 1 to N, as in 1/2")
    return int(k), int(of)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a dozen records, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--family", choices=tuple(FAMILIES), default="report", help="which seeds and effects")
    parser.add_argument("--folder", type=Path, default=Path("benchmark-gap"), help="where diagnoses are kept")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after so long; the next call goes on")
    parser.add_argument(
        "--learn", action="store_true", help="print kind of answer -> (right, of), for gap/answers/sureness.py"
    )
    parser.add_argument("--only", default="", help="only runs whose key contains this")
    parser.add_argument(
        "--part", type=_part, default=(0, 0), metavar="K/N", help="only every N-th record, from the K-th on"
    )
    parser.add_argument(
        "--bare", action="store_true", help="without the refitted baselines and the oracle of what shows"
    )
    told = parser.parse_args()
    runs = in_turn([run for run in benchmark(told.family) if told.only in run.key])
    large = in_turn([run for run in plant_runs(told.family) if told.only in run.key])
    if told.quick:
        runs, large = [run for run in runs if run.setting == "ideal" and run.severity == "typical"][:6], []
    if told.part[1]:
        runs, large = (some[told.part[0] - 1 :: told.part[1]] for some in (runs, large))
    until = time.monotonic() + 60.0 * told.minutes
    found = list(rows(runs, told.folder, until - time.monotonic(), told.part, told.bare))
    file, also = part_file(told.folder, "plant", told.part), sorted(told.folder.glob("plant*.jsonl"))
    plant = list(resumed(large, plant_row, file, until - time.monotonic(), also))
    if told.learn:
        from gap.answers.sureness import counted

        seen = [r | {"right": right(r)} for r in found if r["visible"] > VISIBLE or not (r["effects"] or r["outside"])]
        print(counted(seen))
    out, counts = figures(found, plant)
    made, of = len(found) + len(plant), len(runs) + len(large)
    if told.json != "-":
        print(f"{made} of {of} records; shares with their count and interval of 95 %:")
        for name, count in counts.items():
            print(f"  {name:24} {count}")
    met = publish(out, NOTES, told.json, told.quick or made < of)
    raise SystemExit(0 if met else 1)


if __name__ == "__main__":
    main()
