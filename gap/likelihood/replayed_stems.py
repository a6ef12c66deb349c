"""Fit a stem that sticks where its loop is replayed: its likelihood has many troughs and one deep, narrow one.

1. Where the stem itself is logged its sizes are read off its figure (``figure``).
2. Else a grid over the band S - J and the share J / S, and patterns of points around the best few, on the
   first part of the record, with the modes as the replay has them, which makes the deep trough wide.
3. From its bottom patterns, ever smaller, with wrong modes set right.  These repair wrong sizes as well, by many more
   of them, so here each costs more.
4. Where the modes are right innovations have slopes: steps along these on the whole record, and patterns again where
   they leave something.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.gap.likelihood.figure import read_off
from stickslip.gap.likelihood.fit import Fit, refined, unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.left import share
from stickslip.gap.likelihood.settling import free_names
from stickslip.gap.records.record import Record

FIRST = 14  # bands
SHARES, MOST = (0.0, 0.12, 0.25, 0.4, 0.6, 0.85), 0.99  # jumps as a share of S, and the largest
KEPT, APART = 4, 0.3  # troughs that are followed, and how far apart their bands are, as a logarithm
BEGUN, SAME = 2, 0.03  # troughs from which modes are set right; nearer ones have run into each other
DEARER = 4.0  # times their charge that modes set right cost besides, in the search
SHRINK, WIDER = 0.55, 0.9  # of a pattern from round to round; of one that has moved
FINEST, MOST_ROUNDS = 2e-3, 40  # relative size of the last pattern, and how many there are
HEAD, FEWEST = 0.2, 1200  # share of a record, and rows at least, that show enough slips
WIDE, AROUND = 0.12, (0.1, 0.1)  # first widths of a pattern in the share, and around values that are nearly right
READ, GOOD = (0.03, 0.05), 0.85  # the same around values read off a log; share that is explained if it was a stem's
WORTH, CLEAN = 0.3, 0.9  # share of the gap from which on, up to which patterns are followed in all rows
AGAIN, ROUNDS = (0.05, 0.12), 20  # widths of the first there, and how many there are
# of points around the best, as shares of their widths; the second half where the first is no better
PATTERNS = (
    ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, 0.7), (-0.7, -0.7)),
    ((-0.4, 0.0), (0.4, 0.0), (0.0, -0.4), (0.0, 0.4), (0.7, -0.7), (-0.7, 0.7)),
)
PATTERNS_FLAT = (((-1.0, 0.0), (1.0, 0.0), (-0.4, 0.0), (0.4, 0.0)),)

Point = tuple[float, float]  # the band S - J in which a stem slides, which a log tells best, and J as a share of S


@dataclass(frozen=True)
class Trough:
    """The ``best`` trial of a stem so far, and the widths of the pattern around it."""

    best: Innovations
    wide: float
    across: float


@dataclass(frozen=True, eq=False)
class Search:
    """Trials of a stem, with ``free`` values of all else; ``modes``: wrong ones are set right."""

    one: Hypothesis
    free: dict[str, float]
    modes: bool

    def at(self, points: Sequence[Point]) -> list[Innovations]:
        """Return what replays of these sizes leave, without those that cannot be."""
        one = self.one
        assert one.effect is not None
        _, high = self._ends
        first = [min(band / (1.0 - part), high) for band, part in points]
        sizes = [dict(zip(one.own, (S, part * S), strict=False)) for S, (_, part) in zip(first, points, strict=True)]
        legal = [own for own in sizes if not one.effect.rules(one.frame.model, one.place, own)]
        return [x for x in one.replayed([{**self.free, **own} for own in legal], self.modes) if x is not None]

    def grid(self) -> list[Innovations]:
        """Return trials over the whole range of sizes."""
        shares = SHARES if len(self.one.own) > 1 else (0.0,)
        return self.at([(float(band), part) for band in np.geomspace(*self._ends, FIRST) for part in shares])

    @property
    def _ends(self) -> tuple[float, float]:
        return self.one.bounds[self.one.own[0]]

    def followed(self, trough: Trough, rounds: int = MOST_ROUNDS) -> Trough:
        """Return the bottom of a trough, by patterns of points that become smaller."""
        best, wide, across = trough.best, trough.wide, trough.across
        for _ in range(rounds):
            if wide < FINEST:
                break
            ahead = self._ahead(best, wide, across)
            less = SHRINK if ahead is None else WIDER
            best, wide, across = ahead or best, less * wide, less * across
        return Trough(best, wide, across)

    def _ahead(self, best: Innovations, wide: float, across: float) -> Innovations | None:
        """Return a better trial of a pattern around the best; None if there is none."""
        low, high = self._ends
        band, part = _point(best)
        for pattern in PATTERNS if len(self.one.own) > 1 else PATTERNS_FLAT:
            points = [
                (float(np.clip(band * np.exp(wide * a), low, high)), float(np.clip(part + across * b, 0.0, MOST)))
                for a, b in pattern
            ]
            ahead = min(self.at(points), key=_cost, default=best)
            if _cost(ahead) < _cost(best):
                return ahead
        return None


def replayed_stem(one: Hypothesis) -> Fit | None:
    """Return the fit of a stem; None if no replay succeeds.

    Its noise is as the model states it: the model alone may take a stem for noise.
    """
    f = one.frame
    head = one.of(replace(f, record=head_of(one)))
    free = dict(f.stated)
    plain, right = Search(head, free, False), Search(head, free, True)
    best = _read(right, one) or _searched(plain, right)
    whole = Search(one, free, True)
    begun = [] if best is None else whole.at([_point(best)])
    if not begun:
        return None
    found = refined(begun[0], one.own).best  # noise that is free would take what wrong sizes leave
    absent = unfitted(Hypothesis(f).filtered(free))
    if WORTH <= share(unfitted(found), absent) < CLEAN:
        found = refined(whole.followed(Trough(found, *AGAIN), ROUNDS).best, one.own).best
    return refined(found, free_names(one))


def head_of(one: Hypothesis) -> Record:
    """Return the first part of a record, which shows enough slips."""
    f = one.frame
    return f.record.first_part(max(HEAD, min(1.0, FEWEST / len(f.Y))))


def _read(right: Search, one: Hypothesis) -> Innovations | None:
    """Return the sizes that the log of the stem itself shows; None if they are not good."""
    begun = min(right.at([(S * (1.0 - part), part) for S, part in read_off(one)]), key=_cost, default=None)
    if begun is None:
        return None
    found = right.followed(Trough(begun, *READ)).best
    absent = unfitted(Hypothesis(right.one.frame).filtered(right.free))
    return found if share(unfitted(found), absent) >= GOOD else None


def _searched(plain: Search, right: Search) -> Innovations | None:
    """Return the sizes of the lowest cost on the first part of the record."""
    low, high = plain.one.bounds[plain.one.own[0]]
    wide = float(np.log(high / low)) / (FIRST - 1) * 0.5
    ends = [Trough(x, wide, WIDE) for x in _apart(sorted(plain.grid(), key=_cost))]
    if not ends:
        return None
    for few in (len(ends), BEGUN):  # two rounds for each, two more for the best
        ends[:few] = [plain.followed(end, rounds=2) for end in ends[:few]]
        ends.sort(key=lambda end: _cost(end.best))
    near = _apart([end.best for end in ends[:BEGUN]], SAME)
    found = [right.followed(Trough(x, *AROUND)).best for x in right.at(list(map(_point, near)))]
    bottoms = [plain.followed(end).best for end in ends[:BEGUN]]
    found += [right.followed(Trough(x, *READ)).best for x in right.at(list(map(_point, bottoms)))]
    return min(found, key=_cost, default=ends[0].best)


def _cost(found: Innovations) -> float:
    """Return what the search goes by: modes that are set right cost more there."""
    return found.nll + DEARER * found.charge


def _point(found: Innovations) -> Point:
    S, *jump = (found.values[name] for name in found.hypothesis.own)
    part = jump[0] / S if jump and S > 0.0 else 0.0
    return S * (1.0 - min(part, MOST)), min(part, MOST)


def _apart(found: Sequence[Innovations], least: float = APART) -> list[Innovations]:
    """Return the best of trials, which are in order, that lie in troughs of their own."""
    kept: list[Innovations] = []
    for one in found:
        if all(abs(np.log(_point(one)[0] / _point(other)[0])) > least for other in kept):
            kept.append(one)
    return kept[:KEPT]
