"""How well the gap between a model and a log is diagnosed, on records of a program that shares no code with it.

Resumable: each diagnosis is one line of a file in ``--folder``; what is there is not made again.  Records come in an
order of which every beginning holds each kind by its share.  ``--part 1/2`` and ``--part 2/2`` make every other record,
for two processes at once; without ``--part`` all rows in the folder are read.  ``--bare`` leaves out the two baselines
that refit and the oracle of what shows: then no record is left out but one that leaves no trace.
``--csv`` writes every row as a table.

``--only foreign`` diagnoses plants of another hand instead (``benchmarks/foreign``), ``--only foreign/cone`` one,
``--only foreign/unseen`` the four with which no method was made.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.foreign.command import foreign
from benchmarks.gap.baselines import free_run_place, shrinkages
from benchmarks.gap.generator import FAMILIES
from benchmarks.gap.models import model
from benchmarks.gap.oracle import possible, right
from benchmarks.gap.plant import runs as plant_runs
from benchmarks.gap.plant_rows import plant_row
from benchmarks.gap.required import NOTES, figures
from benchmarks.gap.runs import VISIBLE, Run, benchmark
from benchmarks.gap.scoring import judged
from benchmarks.gap.table import write_table
from benchmarks.gap.visible import traced
from benchmarks.report import publish
from benchmarks.resumed import in_turn, part_file, resumed


def rows(
    runs: Sequence[Run], folder: Path, seconds: float, part: tuple[int, int] = (0, 0), bare: bool = False
) -> Iterator[dict[str, Any]]:
    """Return what each run came to, those made earlier and kept in the folder among them."""
    first: set[str] = set()
    also = sorted(folder.glob("diagnoses*.jsonl"))
    yield from resumed(runs, lambda run: _row(run, first, bare), part_file(folder, "diagnoses", part), seconds, also)


def _row(run: Run, first: set[str], bare: bool) -> dict[str, Any]:
    from stickslip.gap import diagnose
    from stickslip.logs import Log

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
        "--learn", action="store_true", help="print kind of answer -> (right, of), for gap/answers/hit_rates.py"
    )
    parser.add_argument("--only", default="", help="only runs whose key contains this; 'foreign': those plants")
    parser.add_argument(
        "--part", type=_part, default=(0, 0), metavar="K/N", help="only every N-th record, from the K-th on"
    )
    parser.add_argument(
        "--bare", action="store_true", help="without the refitted baselines and the oracle of what shows"
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also write every row as a table")
    options = parser.parse_args()
    if options.only.startswith("foreign"):
        raise SystemExit(0 if foreign(options) else 1)
    runs = in_turn([run for run in benchmark(options.family) if options.only in run.key])
    large = in_turn([run for run in plant_runs(options.family) if options.only in run.key])
    if options.quick:
        runs, large = [run for run in runs if run.setting == "ideal" and run.severity == "typical"][:6], []
    if options.part[1]:
        runs, large = (some[options.part[0] - 1 :: options.part[1]] for some in (runs, large))
    until = time.monotonic() + 60.0 * options.minutes
    found = list(rows(runs, options.folder, until - time.monotonic(), options.part, options.bare))
    file, also = part_file(options.folder, "plant", options.part), sorted(options.folder.glob("plant*.jsonl"))
    plant = list(resumed(large, plant_row, file, until - time.monotonic(), also))
    if options.learn:
        from stickslip.gap.answers.hit_rates import counted

        seen = [r | {"right": right(r)} for r in found if r["visible"] > VISIBLE or not (r["effects"] or r["outside"])]
        print(counted(seen))
    if options.csv is not None:
        write_table([*found, *plant], options.csv)
    out, counts = figures(found, plant)
    made, of = len(found) + len(plant), len(runs) + len(large)
    if options.json != "-":
        print(f"{made} of {of} records; shares with their count and interval of 95 %:")
        for name, count in counts.items():
            print(f"  {name:24} {count}")
    met = publish(out, NOTES, options.json, options.quick or made < of)
    raise SystemExit(0 if met else 1)


if __name__ == "__main__":
    main()
