"""Levels that a deadband without jump makes cycle: how many are called sticky, and what guarding against it costs.

    python -m benchmarks.detect --only levels [--quick]

No simulation that the model learns from has such loops.  In a process known to integrate stiction is therefore called
from a higher probability on (``stickslip.detect.judge.answer.LEVEL``), which lets 2 % of them pass.  ``level_limit`` is
the probability that would do so on these loops: to be written there when the model changes.  Seeds are used for nothing
else.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from stickslip.calibration import draw, simulate
from stickslip.calibration.spec import Kinds
from stickslip.detect.judge.answer import LEVELS_CYCLE, answer
from stickslip.detect.prepare.prepared import Prepared

from benchmarks.report import Figures

SEEDS: dict[Kinds, int] = {"levels": 63_100, "usual": 63_101}
LOOPS: dict[Kinds, int] = {"levels": 400, "usual": 1000}
ALLOWED = 0.02  # of the loops without stiction, as everywhere

NOTES = {
    "level_false_alarms": "levels that a deadband makes cycle, known to be levels, called sticky (goal: at most 0.02)",
    "level_false_alarms_before": "the same by the limit of all other loops",
    "level_found": "sticky valves found in loops known to integrate",
    "level_found_before": "the same by the limit of all other loops",
    "level_coverage": "sticky valves found in all loops",
    "level_coverage_before": "the same by the limit of all other loops",
    "level_limit": "probability above which 2 % of these levels lie",
}


class Seen(NamedTuple):
    """A loop: whether it sticks, is known to integrate, is called, is kept open as a level alone, and how probable."""

    sticky: bool
    integrates: bool
    called: bool
    kept: bool
    p: float


def seen(kinds: Kinds, n: int) -> list[Seen]:
    """Judge ``n`` loops."""
    found = []
    for record, truth in simulate(draw(n, SEEDS[kinds], kinds=kinds), 1):
        said = answer(Prepared(record))
        p = said.probability if said.probability is not None else float(said.word == "stiction")
        integrates = record.process == "integrating"
        kept = LEVELS_CYCLE in said.reason
        found.append(Seen(truth.cause == "stiction", integrates, said.word == "stiction", kept, p))
    return found


def share(loops: Sequence[Seen], called: Callable[[Seen], bool]) -> float | None:
    """Return the share of the loops that are called, None of none."""
    return float(np.mean([called(one) for one in loops])) if loops else None


def figures(quick: bool = False) -> Figures:
    """Return all figures."""
    part = 20 if quick else 1
    levels, usual = (seen(kinds, LOOPS[kinds] // part) for kinds in ("levels", "usual"))
    known = [one for one in levels if one.integrates]
    sticky = [one for one in usual if one.sticky]

    def before(one: Seen) -> bool:
        return one.called or one.kept

    def now(one: Seen) -> bool:
        return one.called

    found: Figures = {}
    for name, loops in (
        ("level_false_alarms", known), ("level_found", [one for one in sticky if one.integrates]),
        ("level_coverage", sticky),
    ):  # fmt: skip
        found[name], found[f"{name}_before"] = share(loops, now), share(loops, before)
    found["level_limit"] = float(np.quantile([one.p for one in known], 1.0 - ALLOWED)) if known else None
    return found
