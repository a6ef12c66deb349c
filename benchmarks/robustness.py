"""How many random plants integrate, and why the others do not.

    python -m benchmarks.robustness [--quick] [--json FILE]

Random production plants (``stickslip.cases.random_plants``: every parameter +-20 %, feeds, kicks, stiction, stems,
anti-surge, turbine) until 500 could be built; each runs 2000 s with balances of its balances inside the model.  It
counts as integrated if the status is OK, every logged value is finite and within physical bounds, and all balances
close. What could not be built was refused with the numbers.  ``--quick`` runs 40.
"""

import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from stickslip.cases.random_plants import Outcome, RandomPlant, feasible, run
from stickslip.logs.processes import cores

from benchmarks.report import Figures, options, publish

PLANTS, QUICK = 500, 40

NOTES = {
    "random_plants": "feasible random plants run, 2000 s each",
    "integrated": "of them to the end, finite, physical and with closed balances",
    "share": "integrated / random_plants (goal: at least 0.95)",
    "explained": "share of the others that ended with a status and a reason (goal: at least 1)",
    "refused": "drawn besides and refused at build time",
    "refused_with_numbers": "share of them whose message gives numbers (goal: at least 1)",
    "largest_balance_error": "moles and gas, relative to what is held",
    "largest_energy_error": "energy of the shaft, relative",
}


def share(found: Sequence[bool]) -> float:
    """Return the share of what is true, 1 of nothing.

    >>> share([True, False]), share([])
    (0.5, 1.0)
    """
    return sum(found) / len(found) if found else 1.0


def main() -> None:
    """Run them and print the counts; tell on standard error what did not integrate."""
    chosen = options(__doc__.splitlines()[0])
    drawn = list(feasible(QUICK if chosen.quick else PLANTS))
    refused = [plant for _, plant in drawn if isinstance(plant, str)]
    built = [(asked, plant) for asked, plant in drawn if not isinstance(plant, str)]
    done = 0

    def one(index: int) -> tuple[RandomPlant, Outcome]:
        nonlocal done
        asked, plant = built[index]
        outcome = run(asked, plant)
        done += 1
        if sys.stderr.isatty():
            print(f"\r{done} of {len(built)}", end="", file=sys.stderr)
        return asked, outcome

    with ThreadPoolExecutor(cores()) as pool:
        outcomes = list(pool.map(one, range(len(built))))
    good = [outcome for _, outcome in outcomes if outcome.integrated]
    others = [(asked, outcome) for asked, outcome in outcomes if not outcome.integrated]
    figures: Figures = {
        "random_plants": len(built),
        "integrated": len(good),
        "share": len(good) / len(built),
        "explained": share([bool(outcome.reason) for _, outcome in others]),
        "refused": len(refused),
        "refused_with_numbers": share([any(sign.isdigit() for sign in text) for text in refused]),
        "largest_balance_error": max(outcome.balance for outcome in good),
        "largest_energy_error": max(outcome.energy for outcome in good),
    }
    for status, count in sorted(Counter(outcome.status for _, outcome in others).items()):
        figures[f"status_{status}"] = count
    for asked, outcome in others:
        print(f"{outcome.status} after {outcome.ended:g} s: {outcome.reason}\n    {asked.described()}", file=sys.stderr)
    raise SystemExit(0 if publish(figures, NOTES, chosen.json, chosen.quick) else 1)


if __name__ == "__main__":
    main()
