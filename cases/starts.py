"""The rows of the tables over several sets of starts that no search has seen.

Set E was found on the starts of seed 2009, so what it meets there is in part luck of these starts.  ``fresh`` runs a
plant from sets of starts that were drawn afterwards; a row then has the median over all of them, and the share of the
sets whose own median meets it.  ``grouped`` finds the rows by which parameter sets differ: many are met by any plant
of this kind, and agreement there says nothing about the parameters.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numpy as np
from stickslip.cases.kicks import FRESH, KICKS, Studies, Study
from stickslip.cases.tables import Row, table_5_4, table_6_1, table_6_2, table_case_2

BUILDERS = (table_5_4, table_6_1, table_6_2, table_case_2)
Key = tuple[str, str]  # table and row
Progress = Callable[[int, str, int, int, int], None]  # set of starts, F_s, case, done, kicks


class Pooled:
    """Several studies of one plant as one, with all their starts: ``Pooled(parts)("high", 1)``."""

    def __init__(self, parts: Sequence[Studies]) -> None:
        self.parts, self.plant = parts, parts[0].plant

    def __call__(self, F_s: str, case: int) -> Study:
        """Return the study of a size of stiction in a case, over all starts."""
        found = [part(F_s, case) for part in self.parts]
        numbers = {name: np.concatenate([one.numbers[name] for one in found]) for name in found[0].numbers}
        return Study(numbers, sum(one.kicks for one in found), sum(one.failed for one in found))


@dataclass(frozen=True)
class Fresh:
    """Rows over all starts, and for every set of ``starts`` starts by itself which of the judged rows it meets."""

    rows: tuple[Row, ...]
    sets: tuple[Mapping[Key, bool], ...]
    starts: int = KICKS

    def met(self, keys: Collection[Key] | None = None) -> tuple[float, int, int]:
        """Return how many rows (of ``keys``, default all) a set of starts meets: median, least, most.

        >>> Fresh((), ({("5.4", "a"): True}, {("5.4", "a"): False}, {("5.4", "a"): True})).met()
        (1, 0, 1)
        """
        counts = [sum(met for key, met in one.items() if keys is None or key in keys) for one in self.sets]
        return median(counts), min(counts), max(counts)


def judged(rows: Sequence[Row]) -> dict[Key, bool]:
    """Return for each row with a tolerance whether it is met."""
    return {(row.table, row.row): row.within for row in rows if row.within is not None}


def plant_rows(studies: Any) -> list[Row]:
    """Return all rows of the plant: tables 5.4, 6.1, 6.2 and what the thesis says of the sine."""
    return [row for builder in BUILDERS for row in builder(studies)]


def fresh(plant: Any, seeds: Sequence[int] = FRESH, kicks: int = KICKS, progress: Progress | None = None) -> Fresh:
    """Run a plant (a set's name or a ``Production``) from one set of ``kicks`` starts a seed and judge it.

    >>> found = fresh("A", seeds=(1, 2), kicks=1)
    >>> len(found.sets), found.rows[0].held
    (2, 1.0)
    """

    def doing(number: int) -> Callable[[str, int, int, int], None] | None:
        return None if progress is None else lambda F_s, case, done, total: progress(number, F_s, case, done, total)

    parts = [Studies(plant, kicks, seed, doing(number)) for number, seed in enumerate(seeds)]
    sets = tuple(judged(plant_rows(part)) for part in parts)
    rows = []
    for row in plant_rows(Pooled(parts)):
        own = [one[row.table, row.row] for one in sets if (row.table, row.row) in one]
        rows.append(replace(row, held=sum(own) / len(own) if own and len(sets) > 1 else None))
    return Fresh(tuple(rows), sets, kicks)


def grouped(sets: Sequence[Mapping[Key, bool]]) -> tuple[set[Key], set[Key], set[Key]]:
    """Return the rows that all meet, that none meets, and the others, which some meet and some do not.

    >>> grouped([{("5.4", "a"): True, ("5.4", "b"): True}, {("5.4", "a"): True, ("5.4", "b"): False}])
    ({('5.4', 'a')}, set(), {('5.4', 'b')})
    """
    keys = set(sets[0])
    everyone = {key for key in keys if all(one[key] for one in sets)}
    nobody = {key for key in keys if not any(one[key] for one in sets)}
    return everyone, nobody, keys - everyone - nobody
