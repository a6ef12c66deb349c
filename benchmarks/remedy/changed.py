"""Two times of hidden loops, is what changed named?  ``python -m benchmarks.remedy.changed [--plants N] [--json F]``.

Each plant is logged four times: at first, later, and later with one thing changed or another (``Plant.later``).  Load
and noise of each time are drawn anew.  Three pairs follow: the first time with each of the later ones.

right   the change is named first          beside  something else is named with it, and is wrong
none    nothing is named                   wrong   something else is named first
refused     no loop could be fitted, or the change makes the hidden loop run away; counted nowhere else
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import count, islice
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.remedy import FitError, changes, fit
from stickslip.remedy.loop_fit import LoopFit

from benchmarks.remedy.plants import LAWS, Plant
from benchmarks.remedy.rows import appended, kept

CHANGES = (
    "stiction", "process_gain", "controller_gain", "stiction_gone", "sensor_drift", "dead_time",
    "controller_integral_time", "disturbance", "sensor_noise",
)  # fmt: skip


def pairs(seed: int, asked: Sequence[str]) -> list[dict[str, Any]]:
    """What is named without a change and with each of those ``asked``."""
    plant, found, first = Plant.drawn(seed), [], None
    for change in ("nothing", *asked):
        row: dict[str, Any] = {"seed": seed, "law": plant.law, "integrating": plant.integrating, "change": change}
        try:
            first = first or fit(plant.record())
            found.append(row | _named(first, plant.later(change)))
        except FitError as fault:
            found.append(row | {"named": [], "refused": str(fault)})
    return found


def _named(first: LoopFit, later: Plant) -> dict[str, Any]:
    record = later.record()
    if not np.all(np.abs(record.op - 50.0) <= 50.0):
        raise FitError("the hidden loop runs away: OP leaves its span")
    answer = changes(first, fit(record))
    return {
        "named": [one.effect for one in answer.changed],
        "all": {one.effect: [one.nats, one.earlier.value, one.later.value] for one in answer.compared},
    }


def summary(rows: Sequence[dict[str, Any]]) -> list[str]:
    """A line for each change, and for none."""
    lines, right, refused = [], 0, sum("refused" in row for row in rows)
    rows = [row for row in rows if "refused" not in row]
    moved = [row for row in rows if row["change"] != "nothing"]
    for change in CHANGES:
        own = [row["named"] for row in moved if row["change"] == change]
        effect = change.replace("_gone", "")
        hit = [named for named in own if named[:1] == [effect]]
        right += len(hit)
        lines.append(
            f"{change:26} {len(own):3} pairs: right {len(hit)}, of these beside a wrong one "
            f"{sum(len(named) > 1 for named in hit)}, none {sum(not named for named in own)}, wrong "
            f"{sum(bool(named) and named[0] != effect for named in own)}"
        )
    still = [row["named"] for row in rows if row["change"] == "nothing"]
    lines.append(f"all changes                {len(moved):3} pairs: right {right}")
    lines.append(f"refused                    {refused:3} pairs")
    lines.append(f"nothing                    {len(still):3} pairs: none named {sum(not named for named in still)}")
    return lines


def main() -> None:
    """Fit the pairs that the file does not have yet and print how often the change is named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plants", type=int, default=45)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--json", type=Path, help="append each pair to this file; what it has is not run again")
    given = parser.parse_args()
    rows = kept(given.json)
    done = {row["seed"] for row in rows}
    sticky = (seed for seed in count(given.first) if LAWS[seed % len(LAWS)] != "sound")
    for i, seed in enumerate(islice(sticky, given.plants)):
        if seed not in done:
            asked = [CHANGES[(2 * i + k) % len(CHANGES)] for k in (0, 1)]
            rows += appended(given.json, pairs(seed, asked))
    print("\n".join(summary(rows)))


if __name__ == "__main__":
    main()
