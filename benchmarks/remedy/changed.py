"""Two times of hidden loops: is what changed named?  ``python -m benchmarks.remedy.changed [--pairs N] [--first N]``.

Pair i is of the plant of seed i that sticks; one thing changes, in turn nothing, the stick, the gain of the process, or
a value of the controller.  Right is the change that is named first, and no name where nothing changed.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from stickslip.remedy import FitError, changes, fit

from benchmarks.remedy.plants import LAWS, Plant

TURN = ("nothing", "stiction", "process_gain", "controller_gain", "nothing", "controller_integral_time")


def main() -> None:
    """Fit the pairs and print how often the change is named right."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=30)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--json", type=Path, help="write the rows here")
    given = parser.parse_args()
    rows = []
    for i in range(given.pairs):
        seed = given.first + i + i // (len(LAWS) - 1)  # every last law is sound
        plant, change = Plant.drawn(seed), TURN[i % len(TURN)]
        try:
            found = changes(fit(plant.record()), fit(plant.later(change).record()))
            named = [one.effect for one in found.changed]
        except FitError:
            named = ["refused"]
        rows.append({"seed": seed, "law": plant.law, "change": change, "named": named})
        if given.json:
            given.json.write_text(json.dumps(rows))
    moved = [row for row in rows if row["change"] != "nothing"]
    still = [row for row in rows if row["change"] == "nothing"]
    right = sum(row["named"][:1] == [row["change"]] for row in moved)
    print(
        f"change named first: {right} of {len(moved)}; among what is named: "
        f"{sum(row['change'] in row['named'] for row in moved)}"
    )
    print(f"nothing changed and nothing named: {sum(not row['named'] for row in still)} of {len(still)}")


if __name__ == "__main__":
    main()
