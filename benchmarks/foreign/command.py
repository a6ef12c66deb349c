"""What ``python -m benchmarks.gap --only foreign`` does: diagnose, keep each row at once, print the figures.

A plant without a model in ``benchmarks/foreign_models`` is left out, and named.  Figures are of the fourteen; those of
the unseen four stand apart, and are published where no other plant is asked for (``--only foreign/unseen``).
"""

import csv
import sys
import time
from argparse import Namespace
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.logs.files.write import replacing

from benchmarks.foreign.record import NAMES, UNSEEN
from benchmarks.foreign.scoring import NOTES, by_plant, figures
from benchmarks.foreign.trial import chosen, diagnosed, runs, wired
from benchmarks.report import publish
from benchmarks.resumed import in_turn, part_file, resumed


def foreign(given: Namespace) -> bool:
    """Run the benchmark; return whether no requirement is missed (a quick or stopped run misses none)."""
    asked = in_turn(list(chosen(runs(), given.only, given.quick)))
    if given.part[1]:
        asked = asked[given.part[0] - 1 :: given.part[1]]
    name = "foreign_quick" if given.quick else "foreign"
    file, also = part_file(given.folder, name, given.part), sorted(given.folder.glob(f"{name}_[0-9]*.jsonl"))
    rows, begin = [], time.monotonic()
    for row in resumed(asked, diagnosed, file, 60.0 * given.minutes, also):
        rows.append(row)
        spent = (time.monotonic() - begin) / 60.0
        print(f"\r{len(rows)} of {len(asked)} records, {spent:.1f} min  {row['key']:70.70}", end="", file=sys.stderr)
    print(file=sys.stderr)
    if given.csv is not None and rows:
        _write(rows, given.csv)
    seen = [row for row in rows if row["plant"] not in UNSEEN]
    unseen = [row for row in rows if row["plant"] in UNSEEN]
    out, words = figures(seen or unseen)
    if given.json != "-":
        missing = [one for one in (*NAMES, *UNSEEN) if wired(one) is None]
        print("\n".join(by_plant(rows)))
        print(f"{len(rows)} of {len(asked)} records" + (f"; no model of {', '.join(missing)}" if missing else ""))
        print("shares with their count and interval of 90 %:")
        for share, word in words.items():
            print(f"  {share:26} {word}")
        if seen and unseen:
            print("of the unseen plants:")
            for share, word in figures(unseen)[1].items():
                print(f"  {share:26} {word}")
    return publish(out, NOTES, given.json, given.quick or len(rows) < len(asked) or given.only != "foreign")


def _write(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    names = list(dict.fromkeys(name for row in rows for name in row))
    with replacing(path) as part, part.open("w", newline="") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        table.writerows(rows)
