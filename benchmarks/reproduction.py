"""What the agreement with the thesis is worth: fresh starts, other sets of parameters, random plants.

    python -m benchmarks.reproduction [--quick] [--json FILE]

Counts of the rows in tolerance (``stickslip.cases.tables``).  Set E is judged on ten sets of 100 starts that were not
used to find it; sets A, B and C on the first of these; random plants (``stickslip.cases.random_plants``: every
parameter of A, B or C +-20 %, but stems and feeds as in the thesis) on 24 starts each.  A row that every set of
parameters meets, or that random plants meet as well, says little about the parameters.  ``--quick`` takes 2 starts and
one random plant.
"""

import sys
from dataclasses import replace
from statistics import median

from stickslip.cases.kicks import FRESH, KICKS, Studies
from stickslip.cases.random_plants import draw
from stickslip.cases.starts import Key, fresh, grouped, judged, plant_rows
from stickslip.plant import SETS, InfeasibleFeed
from stickslip.plant.parameters import DEFAULT, Stem

from benchmarks.report import Figures, options, publish

PLANTS, STARTS, SEED = 9, 24, 77

NOTES = {
    "rows": "rows of the plant that have a tolerance",
    "met": "of them met by set E, median over sets of fresh starts",
    "met_least": "the least in one set of starts",
    "met_most": "the most",
    "met_A": "met by set A on the first set of starts",
    "met_B": "by set B",
    "met_C": "by set C",
    "by_all": "rows that A, B, C and E all meet",
    "by_none": "rows that none of them meets",
    "telling": "the others, which tell the sets apart",
    "telling_met": "of them met by set E, median over sets of fresh starts",
    "telling_least": "the least in one set of starts",
    "telling_most": "the most",
    "random_plants": "random plants that can rest at their feed",
    "random_met": "rows that a random plant meets, median",
    "random_least": "the least",
    "random_most": "the most",
    "random_by_all": "rows that all random plants meet",
    "random_telling": "telling rows that a random plant meets, median",
}


def random_rows(plants: int, starts: int) -> list[dict[Key, bool]]:
    """Return for each of so many random plants which rows it meets; those that cannot rest are left out."""
    found: list[dict[Key, bool]] = []
    number = 0
    while len(found) < plants:
        plant = replace(draw(number, SEED).plant, stem=Stem())
        number += 1
        try:
            found.append(judged(plant_rows(Studies(plant, starts))))
        except InfeasibleFeed:
            continue
        _tell(f"random plants: {len(found)} of {plants}")
    return found


def _tell(words: str) -> None:
    if sys.stderr.isatty():
        print(f"\r{words}", end="", file=sys.stderr)


def main() -> None:
    """Measure everything and print it."""
    chosen = options(__doc__.splitlines()[0])
    seeds, kicks = (FRESH[:1], 2) if chosen.quick else (FRESH, KICKS)
    own = fresh(DEFAULT, seeds, kicks, lambda number, *_: _tell(f"starts: {number + 1} of {len(seeds)}"))
    sets = {name: judged(plant_rows(Studies(name, kicks))) for name in SETS if name != DEFAULT}
    everyone, nobody, rest = grouped([judged(own.rows), *sets.values()])
    figures: Figures = {"rows": len(own.sets[0])}
    figures |= dict(zip(("met", "met_least", "met_most"), own.met(), strict=True))
    figures |= {f"met_{name}": sum(of.values()) for name, of in sets.items()}
    figures |= {"by_all": len(everyone), "by_none": len(nobody), "telling": len(rest)}
    figures |= dict(zip(("telling_met", "telling_least", "telling_most"), own.met(rest), strict=True))
    found = random_rows(*(1, 2) if chosen.quick else (PLANTS, STARTS))
    counts = [sum(of.values()) for of in found]
    figures |= {"random_plants": len(found), "random_met": median(counts), "random_least": min(counts)}
    figures |= {"random_most": max(counts), "random_by_all": sum(all(of[key] for of in found) for key in found[0])}
    figures["random_telling"] = median(sum(of[key] for key in rest) for of in found)
    publish(figures, NOTES, chosen.json, chosen.quick)


if __name__ == "__main__":
    main()
