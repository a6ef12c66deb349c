"""The thesis's plant cases: is the verdict right where the thesis's algorithm was not, from many starts?

    python -m benchmarks.thesis_cases [--quick] [--json FILE] [--starts N] [--cells]

The cells of tables 6.1 (constant feed) and 6.2 (sine), and the same loops under severe slugging: level and pressure of
separator 1, with stiction none, normal and high.  Each starts with the contents of the separator 3 % about rest, drawn
from a seed of its own.  Right is "stiction" where the valve sticks, and any other word where it has a deadband without
jump.  The verdict is asked three times: on the log as the plant exports it, with the stem positions; on the log without
them, with the suspects that the survey finds in all its tags; and on PV, OP and SP alone.  Beside it: what the
thesis's algorithm says (R above 1.25 is stiction), and whether the survey of the whole log without stems puts a sticky
valve first among all loops; so it is asked, too, of plants with one sticky valve, and of random plants
(``stickslip.cases.random_plants``, of a seed of their own), beside the share that chance would reach, and what slips it
calls there.  ``--cells`` asks for the verdicts alone.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from stickslip.cases.kicks import DURATION, SIZE, indices
from stickslip.cases.random_plants import feasible
from stickslip.detect.judge.answer import answer
from stickslip.detect.plantwide.survey import survey
from stickslip.detect.prepare.prepared import Prepared
from stickslip.diagram import Diagram, simulate
from stickslip.logs import Log
from stickslip.plant import feed, production_plant

from benchmarks.report import Figures, publish

STARTS, QUICK, SEED = 20, 1, 20_260_901
RANDOM, RANDOM_SEED = 60, 2031  # random plants; the seed is used for nothing else
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
    """One loop under one feed and one size of stiction: verdicts over the starts, and the algorithm's calls.

    ``words`` are the verdicts with the stem in the log, ``tags`` those of all tags without the stems, ``blind`` those
    of PV, OP and SP alone.
    """

    feed: str
    size: str
    loop: str
    words: Counter[str] = field(default_factory=Counter)
    tags: Counter[str] = field(default_factory=Counter)
    blind: Counter[str] = field(default_factory=Counter)
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
        return self._right(self.words)

    @property
    def tags_right(self) -> int:
        """Starts where the verdict of all tags is right without the stems."""
        return self._right(self.tags)

    @property
    def blind_right(self) -> int:
        """Starts where the verdict of PV, OP and SP alone is right."""
        return self._right(self.blind)

    def _right(self, words: Counter[str]) -> int:
        return self.starts - words["stiction"] if self.size == "none" else words["stiction"]

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


def logs_of(kind: str, size: str, starts: int, valves: Sequence[str] = tuple(STICKY)) -> Iterator[Log]:
    """Yield the log of every start that runs to its end, after ``SETTLED`` seconds, with the stem positions.

    >>> next(logs_of("constant", "high", 1)).loops["PCS11"].parts
    {'sp': 'SP_PCS11', 'pv': 'p_1', 'op': 'OP_VPCS1', 'mv': 'MV_VPCS1'}
    """
    plant = plant_of(kind, size, valves)
    rng = np.random.default_rng([SEED, FEEDS.index(kind), SIZES.index(size)])
    names = [f"S1.{name}" for name in ("N_oil", "N_metL", "N_metG")]
    for _ in range(starts):
        contents = plant["S1"].x0 * rng.uniform(1.0 - SIZE, 1.0 + SIZE, 3)
        kicked = plant.starting_at(dict(zip(names, contents.tolist(), strict=True)))
        run = simulate(kicked, DURATION, every=EVERY, method="stiff")
        if run.ok:
            yield run.log.between(SETTLED, DURATION)


def without_stems(log: Log) -> Log:
    """The log as most plants have it: no stem position."""
    stems = {loop.mv for loop in log.loops.values() if loop.mv is not None}
    kept = [name for name in log.names if name not in stems]
    return Log(
        log.t, {name: log[name] for name in kept}, {n: u for n, u in log.units.items() if n in kept},
        {n: s for n, s in log.spans.items() if n in kept}, origin=log.origin,
        loops={tag: replace(loop, mv=None) for tag, loop in log.loops.items()},
    )  # fmt: skip


def measure(starts: int, surveys: bool = True) -> tuple[list[Cell], list[First]]:
    """Judge every cell and, if asked for, survey every log."""
    cells, firsts = [], []
    for kind in FEEDS:
        for size in SIZES:
            if kind == "constant" and size == "none":
                continue  # nothing oscillates there, and the thesis leaves it out
            own = {name: Cell(kind, size, name) for name in LOOPS}
            first = First(kind, size)
            for log in logs_of(kind, size, starts):
                blind = without_stems(log)
                R = indices(log.t, log["V_1"], log["p_1"])
                alone = {tag: answer(Prepared(blind.loop(name=tag))).word for tag in LOOPS.values()}
                seen = {suspect.loop for suspect in survey(blind, alone).suspects if suspect.suspected}
                for name, cell in own.items():
                    tag = LOOPS[name]
                    cell.words[answer(Prepared(log.loop(name=tag))).word] += 1
                    cell.tags["stiction" if tag in seen else alone[tag]] += 1
                    cell.blind[alone[tag]] += 1
                    cell.thesis_sticky += R[f"{name} R"] > R_STICKY
                if surveys:
                    first.add(blind, STICKY)
            cells += own.values()
            firsts += [first] * surveys
            print(f"{kind} {size}: judged", file=sys.stderr, flush=True)
    for valves in ALONE if surveys else ():
        for kind in FEEDS:
            first = First(kind, "high", *valves)
            for log in logs_of(kind, "high", starts, tuple(valves)):
                first.add(without_stems(log), valves)
            firsts.append(first)
            print(f"{kind} {first.valves} alone: surveyed", file=sys.stderr, flush=True)
    return cells, firsts


@dataclass
class AtRandom:
    """Random plants in which the OP of a sticky valve moves: a sticky one first, and what chance would reach.

    ``banded`` counts a first valve with a deadband but hardly a jump, too: those answer as late as sticky ones.
    ``sticky``, ``play`` and ``free`` are loops whose OP moves, with a sticky valve, with a deadband and hardly a jump,
    and with a valve without friction; ``..._slip`` of those are called slipping by another tag.
    """

    plants: int = 0
    first: int = 0
    banded: int = 0
    chance: float = 0.0
    sticky: int = 0
    sticky_slip: int = 0
    play: int = 0
    play_slip: int = 0
    free: int = 0
    free_slip: int = 0


def at_random(draws: int, seed: int = RANDOM_SEED) -> AtRandom:
    """Survey random plants: every number 20 % about its value, any feed, several sticky valves of any size.

    >>> at_random(2).plants <= 2
    True
    """
    found = AtRandom()
    for asked, plant in feasible(draws, seed):
        slipping = {f"OP_{valve}" for valve, F_s in asked.F_s.items() if F_s >= SLIPS * asked.plant.stem.F_c}
        if isinstance(plant, str):
            continue
        run = simulate(plant, DURATION, every=EVERY, method="stiff")
        if not run.ok:
            continue
        log = run.log.between(SETTLED, DURATION)
        sticky = {tag for tag, loop in log.loops.items() if loop.op in slipping}
        seen = survey(without_stems(log)).suspects
        suspects = [s.loop for s in seen]
        slips = {s.loop for s in seen if s.slips is not None}
        free = {tag for tag in suspects if log.loops[tag].op not in {f"OP_{valve}" for valve in asked.F_s}}
        play = set(suspects) - sticky - free
        found.play += len(play)
        found.play_slip += len(play & slips)
        found.sticky += len(sticky & set(suspects))
        found.sticky_slip += len(sticky & slips)
        found.free += len(free)
        found.free_slip += len(free & slips)
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
        "cells_right_of_tags": float(sum(cell.tags_right >= ENOUGH * max(cell.starts, 1) for cell in cells)),
        "cells_right_without_stem": float(sum(cell.blind_right >= ENOUGH * max(cell.starts, 1) for cell in cells)),
        "cells_right_thesis": float(sum(cell.thesis_right >= ENOUGH * max(cell.starts, 1) for cell in cells)),
    }
    for cell in cells:
        found[f"{cell.name}_right"] = cell.right / cell.starts if cell.starts else None
        found[f"{cell.name}_of_tags"] = cell.tags_right / cell.starts if cell.starts else None
        found[f"{cell.name}_without_stem"] = cell.blind_right / cell.starts if cell.starts else None
    for first in firsts:
        share = (first.starts - first.accused if first.size == "none" else first.first) / max(first.starts, 1)
        found[first.name] = share
    return found


def notes(cells: list[Cell], firsts: list[First]) -> dict[str, str]:
    """What each figure means, with the words behind it."""
    words = {
        "cells": "cells of tables 6.1, 6.2 and of slugging",
        "cells_right": f"cells right in 18 of 20 starts, on the plant's own export (goal: at least {len(cells)})",
        "cells_right_of_tags": "the same from the other tags, where the stem positions are not logged",
        "cells_right_without_stem": "the same from PV, OP and SP alone",
        "cells_right_thesis": "the same for the thesis's algorithm",
    }
    for cell in cells:
        words[f"{cell.name}_right"] = f"{_listed(cell.words)}; thesis right in {cell.thesis_right} of {cell.starts}"
        words[f"{cell.name}_of_tags"] = _listed(cell.tags)
        words[f"{cell.name}_without_stem"] = _listed(cell.blind)
    for first in firsts:
        what = "sticky valve first of all loops (goal: at least 0.9)"
        if first.size == "none":
            what = "no valve pointed at; VLCS1 and VPCS1 have a deadband of 4.8 % here"
        words[first.name] = f"{what}, {first.starts} starts"
    return words


def _listed(words: Counter[str]) -> str:
    return ", ".join(f"{n} {word}" for word, n in words.most_common())


def main() -> None:
    """Judge, survey and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="1 start of each, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--starts", type=int, default=STARTS, help="starts of each cell (default 20)")
    parser.add_argument("--cells", action="store_true", help="the verdicts alone, without surveys")
    chosen = parser.parse_args()
    cells, firsts = measure(QUICK if chosen.quick else chosen.starts, not chosen.cells)
    found, words = figures(cells, firsts), notes(cells, firsts)
    random = at_random(0 if chosen.cells else 2 if chosen.quick else RANDOM)
    if random.plants:
        found["random_survey"] = random.first / random.plants
        found["random_banded_survey"] = random.banded / random.plants
        found["random_chance"] = random.chance / random.plants
        found["random_sticky_slip"] = random.sticky_slip / max(random.sticky, 1)
        found["random_play_slip"] = random.play_slip / max(random.play, 1)
        found["random_free_slip"] = random.free_slip / max(random.free, 1)
    words["random_survey"] = f"a sticky valve first of all loops in {random.plants} random plants"
    words["random_banded_survey"] = "a valve first that sticks or has a deadband as wide"
    words["random_chance"] = "what a ranking by chance would reach there"
    words["random_sticky_slip"] = f"of {random.sticky} sticky valves whose OP moves, another tag shows that they slip"
    words["random_play_slip"] = f"the same of {random.play} valves with a deadband and a jump below a tenth of it"
    words["random_free_slip"] = f"the same of {random.free} valves without friction"
    publish(found, words, chosen.json, chosen.quick)


if __name__ == "__main__":
    main()
