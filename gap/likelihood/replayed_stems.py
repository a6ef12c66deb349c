"""Fit a stem that sticks where its loop is replayed: its score has many troughs and one deep, narrow one.

1. A grid over both sizes, the second as a share of the first, and patterns of points around the best few, on the first
   part of the record, with the modes as the replay has them, which makes the deep trough wide.
2. From its bottom patterns, ever smaller, with wrong modes set right.
3. Where the modes are right innovations have slopes: steps along these on the whole record.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.likelihood.figure import read_off
from stickslip.gap.likelihood.fit import Fit, refined, unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.left import share
from stickslip.gap.likelihood.settling import free_names

FIRST = 14  # sizes of the first parameter
SHARES = (0.0, 0.12, 0.25, 0.4, 0.6, 0.85)  # the second as a share of the first
KEPT, APART = 4, 0.3  # troughs that are followed, and how far apart their first sizes are, as a logarithm
BEGUN, SAME = 2, 0.03
DEARER = 4.0  # times their charge that modes set right cost besides, in the search
SHRINK, WIDER = 0.55, 0.9  # of a pattern from round to round; of one that has moved
FINEST = 2e-4  # relative size of the last pattern
HEAD, FEWEST = 0.2, 1200
AROUND = 0.1, 0.1
READ, GOOD = (0.03, 0.05), 0.85  # the same around values read off a log; share that is explained if it was a stem's
PATTERNS = (
    ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, 0.7), (-0.7, -0.7)),
    ((-0.4, 0.0), (0.4, 0.0), (0.0, -0.4), (0.0, 0.4), (0.7, -0.7), (-0.7, 0.7)),
)
PATTERNS_FLAT = (((-1.0, 0.0), (1.0, 0.0), (-0.4, 0.0), (0.4, 0.0)),)
Point = tuple[float, float]


class Search:
    """Trials of a stem on a part of a record."""

    def __init__(self, one: Hypothesis, free: dict[str, float], modes: bool) -> None:
        self.one, self.free, self.modes = one, free, modes

    def at(self, points: Sequence[Point]) -> list[Innovations]:
        sizes = [dict(zip(self.one.own, (size, share * size), strict=False)) for size, share in points]
        legal = [s for s in sizes if not self.one.effect.rules(self.one.frame.model, self.one.place, s)]
        return [x for x in self.one.replayed([{**self.free, **s} for s in legal], self.modes) if x is not None]

    def grid(self) -> list[Innovations]:
        low, high = self.one.bounds[self.one.own[0]]
        shares = SHARES if len(self.one.own) > 1 else (0.0,)
        return self.at([(float(size), share) for size in np.geomspace(low, high, FIRST) for share in shares])

    def followed(self, best: Innovations, wide: float, across: float, rounds: int = 40, finest: float = FINEST):
        low, high = self.one.bounds[self.one.own[0]]
        point = _point(best)
        for _ in range(rounds):
            if wide < finest:
                break
            moved = False
            for pattern in PATTERNS_FLAT if len(self.one.own) < 2 else PATTERNS:
                points = [
                    (
                        float(np.clip(point[0] * np.exp(wide * a), low, high)),
                        float(np.clip(point[1] + across * b, 0.0, 1.0)),
                    )
                    for a, b in pattern
                ]
                ahead = min(self.at(points), key=cost, default=None)
                moved = ahead is not None and cost(ahead) < cost(best)
                if moved:
                    best, point = ahead, _point(ahead)
                    break
            less = WIDER if moved else SHRINK
            wide, across = less * wide, less * across
        return best, wide, across


def cost(found: Innovations) -> float:
    return found.nll + DEARER * found.charge


def _point(found: Innovations) -> Point:
    first, *second = (found.values[name] for name in found.hypothesis.own)
    return first, second[0] / first if second and first > 0.0 else 0.0


def _apart(found: list[Innovations], least: float = APART) -> list[Innovations]:
    kept: list[Innovations] = []
    for one in found:
        if all(abs(np.log(_point(one)[0] / _point(other)[0])) > least for other in kept):
            kept.append(one)
    return kept[:KEPT]


def replayed_stem(one: Hypothesis) -> Fit | None:
    """Return the fit of a stem; None if no replay succeeds."""
    f = one.frame
    free = dict(f.stated)  # the model alone may take a stem for noise
    share = max(HEAD, min(1.0, FEWEST / len(f.Y)))
    head = one.of(replace(f, record=f.record.first_part(share)))
    search, right = Search(head, free, False), Search(head, free, True)
    best = _read(right, one) or _searched(search, right)
    if best is None:
        return None
    whole = Search(one, free, True).at([_point(best)])
    return refined(whole[0], free_names(one)) if whole else None


def _read(right: Search, one: Hypothesis) -> Innovations | None:
    """Return the sizes that the log of the stem itself shows; None if they are not good."""
    begun = min(right.at(read_off(one)), key=cost, default=None)
    if begun is None:
        return None
    found = right.followed(begun, *READ, finest=10.0 * FINEST)[0]
    absent = unfitted(Hypothesis(right.one.frame).filtered(right.free))
    return found if share(unfitted(found), absent) >= GOOD else None


def _searched(search: Search, right: Search) -> Innovations | None:
    """Return the sizes of the lowest cost on the first part of the record."""
    one = search.one
    low, high = one.bounds[one.own[0]]
    wide = float(np.log(high / low)) / (FIRST - 1) * 0.5
    ends = [(x, wide, 0.12) for x in _apart(sorted(search.grid(), key=cost))]
    if not ends:
        return None
    for few in (len(ends), BEGUN):
        ends[:few] = [search.followed(*end, rounds=2) for end in ends[:few]]
        ends.sort(key=lambda end: cost(end[0]))
    begun = [x for end in _apart([end[0] for end in ends[:BEGUN]], SAME) for x in right.at([_point(end)])]
    found = [right.followed(x, *AROUND, finest=10.0 * FINEST)[0] for x in begun]
    return min(found, key=cost, default=ends[0][0])
