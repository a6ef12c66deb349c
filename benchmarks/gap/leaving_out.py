"""How often "unknown" is said where the catalogue lacks the true effect: what the gates of adequacy are set by.

    python -m benchmarks.gap.leaving_out [--setting ideal] [--minutes 30] [--folder benchmark-gap]

Each tuning record with one effect is diagnosed with the catalogue without that effect and all that leave the same log,
or have it as a special case: a stick that does not jump, a step before the first row.  Right is "unknown"; a name is
wrong, and confident if its probability exceeds 0.8.  Resumable: a line of a file each.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.detect.published import wilson

from benchmarks.gap.models import model
from benchmarks.gap.runs import VISIBLE, Run, alike, singles
from benchmarks.gap.scoring import CONFIDENT
from benchmarks.gap.settings import SETTINGS
from benchmarks.gap.severities import SEVERITIES
from benchmarks.resumed import resumed

# effect -> those that have it as a special case
GENERAL = {
    "deadband": ("stiction",), "sensor_bias": ("step_disturbance",), "valve_leak": ("step_disturbance",),
}  # fmt: skip


def leaving_out(runs: Sequence[Run], file: Path, seconds: float) -> Iterator[dict[str, Any]]:
    """Return what each run came to, those made earlier and kept in the file among them."""
    return resumed(runs, left_out, file, seconds)


def left_out(run: Run) -> dict[str, Any]:
    """Return what a diagnosis without the class of a run's effect says."""
    from stickslip.gap import diagnose
    from stickslip.gap.effects import CATALOGUE
    from stickslip.logs import Log

    (name,) = run.effects
    record = run.made()
    signals = {s: v for s, v in record.signals.items() if s not in ("time", "MV")}
    gone = {*alike(name, run.mv, run.setting), *GENERAL.get(name, ())}
    rest = [one for one in CATALOGUE if one.name not in gone]
    report = diagnose(
        model(run.setting), Log(record.signals["time"], signals), catalogue=rest, limits=False, progress=False
    )
    said = [cause.effect for cause in report.causes]
    return {
        "key": run.key, "effect": name, "severity": run.severity, "visible": record.gap, "said": said,
        "probability": report.causes[0].probability if report.causes else None,
    }  # fmt: skip


def table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return a table in words: for each severity how often unknown, no gap and a wrong name were said.

    >>> print(table([{"severity": "typical", "visible": 1.0, "said": ["unknown"], "probability": 0.9}]))
    | severity | unknown | no gap | wrong name | confident | of | unknown, interval of 95 % |
    |---|---|---|---|---|---|---|
    | typical | 1 | 0 | 0 | 0 | 1 | 0.21 to 1.00 |
    """
    lines = ["| severity | unknown | no gap | wrong name | confident | of | unknown, interval of 95 % |"]
    lines.append("|" + "---|" * 7)
    for severity in SEVERITIES:
        here = [row for row in rows if row["severity"] == severity and row["visible"] > VISIBLE]
        if here:
            unknown = sum(row["said"] == ["unknown"] for row in here)
            wrong = [row for row in here if row["said"] and row["said"] != ["unknown"]]
            sure = sum(row["probability"] > CONFIDENT for row in wrong)
            low, high = wilson(unknown, len(here), z=1.96)
            none = len(here) - unknown - len(wrong)
            lines.append(
                f"| {severity} | {unknown} | {none} | {len(wrong)} | {sure} | {len(here)} | {low:.2f} to {high:.2f} |"
            )
    return "\n".join(lines)


def main() -> None:
    """Diagnose, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--setting", choices=tuple(SETTINGS), default="ideal", help="which loop")
    parser.add_argument("--minutes", type=float, default=1e9, help="stop after so long; the next call goes on")
    parser.add_argument("--folder", type=Path, default=Path("benchmark-gap"), help="where diagnoses are kept")
    parser.add_argument("--only", default="", help="only runs whose key contains this")
    options = parser.parse_args()
    runs = [run for run in singles("tuning", options.setting, SEVERITIES[1:], 1) if options.only in run.key]
    rows = list(leaving_out(runs, options.folder / "leaving_out.jsonl", 60.0 * options.minutes))
    print(f"{len(rows)} of {len(runs)} records, each without the class of its effect:")
    print(table(rows))
    for row in rows:
        if row["said"] != ["unknown"] and row["visible"] > VISIBLE:
            print(f"  {row['key']}: {', '.join(row['said']) or 'no gap'}")


if __name__ == "__main__":
    main()
