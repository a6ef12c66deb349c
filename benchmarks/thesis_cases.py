"""The thesis's plant cases: is the verdict right where the thesis's algorithm was not, from many starts?

    python -m benchmarks.thesis_cases [--quick] [--json FILE] [--starts N] [--stem]

The cells of tables 6.1 (constant feed) and 6.2 (sine), and the same loops under severe slugging: level and pressure of
separator 1, with stiction none, normal and high.  Each starts with the contents of the separator 3 % about rest, drawn
from a seed of its own.  Right is "stiction" where the valve sticks, and any other word where it has a deadband without
jump.  Beside it: what the thesis's algorithm says (R above 1.25 is stiction), and whether the survey of the whole log
puts a sticky valve first among all loops; so it is asked, too, of plants with one sticky valve, and of random plants
(``cases.random_plants``), beside the share that chance would reach.  The stem is left out of the log unless ``--stem``.
"""

import argparse
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.report import Figures, publish
from cases.kicks import DURATION, SIZE, indices
from cases.random_plants import feasible
from detect import diagnose
from detect.plantwide.survey import survey
from diagram import Diagram, simulate
from logs import Log
from plant import feed, production_plant

STARTS, QUICK, SEED = 20, 1, 20_260_901
RANDOM = 60  # random plants
SLIPS = 1.2  # F_s over F_c from which a valve of a random plant counts as sticky
EVERY, SETTLED = 1.0, 200.0  # s
FEEDS = ("constant", "sine", "slugs")
SIZES = ("none", "normal", "high")
LOOPS = {"level": "LCS11", "pressure": "PCS11"}
STICKY = {"VLCS1": "LCS11", "VPCS1": "PCS11"}  # valves of tables 6.1 and 6.2, and their loops
ALONE = ({"VLCS1": "LCS11"}, {"VPCS1": "PCS11"}, {"VLCS2": "LCS21"})  # valves that stick one at a time
R_STICKY = 1.25  # of the thesis's index, "clearly above 1"
ENOUGH = 0.9  # of the starts: 18 of 20


@dataclass
class Cell:
    """One loop under one feed and one size of stiction: verdicts over the starts, and the algorithm's calls."""

    feed: str
    size: str
    loop: str
    words: Counter[str] = field(default_factory=Counter)
    codes: Counter[str] = field(default_factory=Counter)
    thesis_sticky: int = 0

    @property
    def name(self) -> str:
        """Feed, size and loop in one word."""
        return f"{self.feed}_{self.size}_{self.loop}"

    @property
    def starts(self) -> int:
        """Starts so far."""
        return sum(self.words.values())

    @property
    def right(self) -> int:
        """Starts where the verdict is right."""
        return self.starts - self.words["stiction"] if self.size == "none" else self.words["stiction"]

    @property
    def thesis_right(self) -> int:
        """Starts where the thesis's algorithm is right."""
        return self.starts - self.thesis_sticky if self.size == "none" else self.thesis_sticky


@dataclass
class First:
    """Over the starts of one feed and size: how often a sticky valve comes first of all loops in the survey."""

    feed: str
    size: str
    valves: str = "both"  # that stick
    starts: int = 0
    first: int = 0
    accused: int = 0  # where the survey points at any valve

    @property
    def name(self) -> str:
        """Feed, size and valves in one word."""
        return f"{self.feed}_{self.size}_{self.valves}_survey"

    def add(self, log: Log, sticky: Mapping[str, str]) -> None:
        """Survey one more log, in which the valves of the loops ``sticky`` (valve -> loop) stick."""
        found = survey(log)
        self.starts += 1
        self.first += bool(found.suspects) and found.suspects[0].loop in sticky.values()
        self.accused += "Look at the valve of" in found.words


def plant_of(kind: str, size: str, valves: Sequence[str] = tuple(STICKY)) -> Diagram:
    """The production plant under a feed ("constant", "sine", "slugs") with some valves of a size of stiction."""
    sticky, name = tuple(valves), f"{kind}_{size}"
    if kind == "slugs":
        return production_plant(sticky=sticky, F_s=size, feed=feed.slugs(), name=name)
    return production_plant(sticky=sticky, F_s=size, case=1 if kind == "constant" else 2, name=name)


def logs_of(
    kind: str, size: str, starts: int, stem: bool = False, valves: Sequence[str] = tuple(STICKY)
) -> Iterator[Log]:
    """Yield the log of every start that runs to its end, after ``SETTLED`` seconds.

    >>> next(logs_of("constant", "high", 1)).loops["PCS11"].parts
    {'sp': 'SP_PCS11', 'pv': 'p_1', 'op': 'OP_VPCS1'}
    """
    plant = plant_of(kind, size, valves)
    rng = np.random.default_rng([SEED, FEEDS.index(kind), SIZES.index(size)])
    names = [f"S1.{name}" for name in ("N_oil", "N_metL", "N_metG")]
    for _ in range(starts):
        contents = plant["S1"].x0 * rng.uniform(1.0 - SIZE, 1.0 + SIZE, 3)
        kicked = plant.starting_at(dict(zip(names, contents.tolist(), strict=True)))
        run = simulate(kicked, DURATION, every=EVERY, method="stiff")
        if run.ok:
            log = run.log.between(SETTLED, DURATION)
            yield log if stem else without_stems(log)


def without_stems(log: Log) -> Log:
    """The log as most plants have it: no stem position."""
    stems = {loop.mv for loop in log.loops.values() if loop.mv is not None}
    kept = [name for name in log.names if name not in stems]
    return Log(
        log.t, {name: log[name] for name in kept}, {n: u for n, u in log.units.items() if n in kept},
        {n: s for n, s in log.spans.items() if n in kept}, origin=log.origin,
        loops={tag: replace(loop, mv=None) for tag, loop in log.loops.items()},
    )  # fmt: skip


def measure(starts: int, stem: bool = False) -> tuple[list[Cell], list[First]]:
    """Judge every cell and survey every log."""
    cells, firsts = [], []
    for kind in FEEDS:
        for size in SIZES:
            if kind == "constant" and size == "none":
                continue  # nothing oscillates there, and the thesis leaves it out
            own = {name: Cell(kind, size, name) for name in LOOPS}
            first = First(kind, size)
            for log in logs_of(kind, size, starts, stem):
                R = indices(log.t, log["V_1"], log["p_1"])
                for name, cell in own.items():
                    answer = diagnose(log.loop(name=LOOPS[name]))
                    cell.words[answer.verdict] += 1
                    cell.codes.update(v.code for v in answer.methods if v.code is not None and not v.experimental)
                    cell.thesis_sticky += R[f"{name} R"] > R_STICKY
                first.add(log, STICKY)
            cells += own.values()
            firsts.append(first)
    for valves in ALONE:
        for kind in FEEDS:
            first = First(kind, "high", *valves)
            for log in logs_of(kind, "high", starts, stem, tuple(valves)):
                first.add(log, valves)
            firsts.append(first)
    return cells, firsts


@dataclass
class AtRandom:
    """Random plants in which the OP of a sticky valve moves: a sticky one first, and what chance would reach.

    ``banded`` counts a first valve with a deadband but hardly a jump, too: those answer as late as sticky ones.
    """

    plants: int = 0
    first: int = 0
    banded: int = 0
    chance: float = 0.0


def at_random(draws: int, stem: bool = False) -> AtRandom:
    """Survey random plants: every number 20 % about its value, any feed, several sticky valves of any size.

    >>> at_random(2).plants <= 2
    True
    """
    found = AtRandom()
    for asked, plant in feasible(draws):
        slipping = {f"OP_{valve}" for valve, F_s in asked.F_s.items() if F_s >= SLIPS * asked.plant.stem.F_c}
        if isinstance(plant, str):
            continue
        run = simulate(plant, DURATION, every=EVERY, method="stiff")
        if not run.ok:
            continue
        log = run.log.between(SETTLED, DURATION)
        sticky = {tag for tag, loop in log.loops.items() if loop.op in slipping}
        suspects = [s.loop for s in survey(log if stem else without_stems(log)).suspects]
        if sticky & set(suspects):
            found.plants += 1
            found.first += suspects[0] in sticky
            found.banded += log.loops[suspects[0]].op in {f"OP_{valve}" for valve in asked.F_s}
            found.chance += len(sticky & set(suspects)) / len(suspects)
    return found


def figures(cells: list[Cell], firsts: list[First]) -> Figures:
    """The counts as flat figures."""
    found: Figures = {
        "cells": float(len(cells)),
        "cells_right": float(sum(cell.right >= ENOUGH * max(cell.starts, 1) for cell in cells)),
        "cells_right_thesis": float(sum(cell.thesis_right >= ENOUGH * max(cell.starts, 1) for cell in cells)),
    }
    for cell in cells:
        found[f"{cell.name}_right"] = cell.right / cell.starts if cell.starts else None
    for first in firsts:
        share = (first.starts - first.accused if first.size == "none" else first.first) / max(first.starts, 1)
        found[first.name] = share
    return found


def notes(cells: list[Cell], firsts: list[First]) -> dict[str, str]:
    """What each figure means, with the words behind it."""
    told = {
        "cells": "cells of tables 6.1, 6.2 and of slugging",
        "cells_right": f"cells right in at least 18 of 20 starts (goal: at least {len(cells)})",
        "cells_right_thesis": "the same for the thesis's algorithm",
    }
    for cell in cells:
        words = ", ".join(f"{n} {word}" for word, n in cell.words.most_common())
        why = f"; {cell.codes.most_common(1)[0][0]}" if cell.codes else ""
        told[f"{cell.name}_right"] = f"{words}{why}; thesis right in {cell.thesis_right} of {cell.starts}"
    for first in firsts:
        what = "sticky valve first of all loops (goal: at least 0.9)"
        if first.size == "none":
            what = "no valve pointed at; VLCS1 and VPCS1 have a deadband of 4.8 % here"
        told[first.name] = f"{what}, {first.starts} starts"
    return told


def main() -> None:
    """Judge, survey and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="1 start of each, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--starts", type=int, default=STARTS, help="starts of each cell (default 20)")
    parser.add_argument("--stem", action="store_true", help="leave the stem positions in the log")
    chosen = parser.parse_args()
    cells, firsts = measure(QUICK if chosen.quick else chosen.starts, chosen.stem)
    found, told = figures(cells, firsts), notes(cells, firsts)
    random = at_random(RANDOM if not chosen.quick else 2, chosen.stem)
    if random.plants:
        found["random_survey"] = random.first / random.plants
        found["random_banded_survey"] = random.banded / random.plants
        found["random_chance"] = random.chance / random.plants
    told["random_survey"] = f"a sticky valve first of all loops in {random.plants} random plants"
    told["random_banded_survey"] = "a valve first that sticks or has a deadband as wide"
    told["random_chance"] = "what a ranking by chance would reach there"
    publish(found, told, chosen.json, chosen.quick)


if __name__ == "__main__":
    main()
