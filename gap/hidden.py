"""Fit an effect with a hidden mode, such as a stem that sticks: its score has many troughs and one deep, narrow one.

A grid over both sizes, the second as a share of the first; then patterns of points around the best few, ever smaller.
Twice on the first part of the record: with the modes as the replay has them, which makes the deep trough wide, and with
wrong ones set right, which is what tells where replays of the true sizes go wrong.  The better one is followed on the
whole record.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gap.search import Candidate, Fit, best_of

FIRST = 14  # sizes of the first parameter
SHARES = (0.0, 0.12, 0.25, 0.4, 0.6, 0.85)  # the second as a share of the first
KEPT = 3  # troughs that are followed
SHRINK = 0.55  # of a pattern from round to round
FINEST = 2e-4  # relative size of the last pattern
ENOUGH = 50.0  # nats that the first part of the record must gain by the effect
HEAD = 0.4  # share of the record that is enough for the search where its first part does not show the gap
FEWEST = 1200  # rows of a first part that show enough slips
WORTH = 0.2  # share of the gap that an effect must explain to be followed on the whole record
LAST, LAST_ROUNDS = 0.005, 12  # least width of the first pattern there, and how many there are
PLACES = 2  # at which hidden modes are looked for where a filter has told which promise most
AROUND = 0.1, 0.1  # first widths of a pattern around values that are nearly right
WIDER = 0.9  # of a pattern that has moved

Point = tuple[float, float]  # the first size, and the second as a share of it


def fitted_hidden(candidate: Candidate) -> Fit | None:
    """Return the best fit of an effect with a hidden mode; None if no run succeeded."""
    tries = (False, True) if candidate.problem.record.filter is None else (False,)  # a filter has no modes to set right
    ends = [_searched(_head(candidate, modes)) for modes in tries]
    fits = _at(candidate, [point for point, _, _ in ends])
    best = best_of(fits)
    if best is None:
        return None
    point, wide, across = ends[fits.index(best)] if len(fits) == len(ends) else ends[0]
    if not candidate.absent.F - WORTH * max(candidate.absent.F - candidate.problem.level, 0.0) > best.F:
        return best  # far from anything that could be named, alone or beside another
    return _followed(candidate, point, best, max(wide, LAST), max(across, LAST), rounds=LAST_ROUNDS)[1]


def glimpsed(candidate: Candidate) -> Fit | None:
    """Return the best fit of an effect with a hidden mode, searched coarsely on the first part of the record."""
    point, _, _ = _searched(_head(candidate, True), fine=False)
    return best_of(_at(candidate, [point]))


def promising(many: Sequence[Candidate]) -> list[Candidate]:
    """Return the effects with a hidden mode that a grid of sizes on the first part of the record speaks for most."""
    scores = {}
    for candidate in many:
        fits = _at(_head(candidate, False), _grid(candidate))
        scores[candidate] = min((fit.F for fit in fits), default=np.inf)
    near = sorted({min(scores[c] for c in many if c.place == place) for place in {c.place for c in many}})[:PLACES]
    return [c for c in many if any(scores[o] in near for o in many if o.place == c.place)]


def _head(candidate: Candidate, modes: bool) -> Candidate:
    """Return a candidate on the first part of the record, with wrong modes set right or as replays have them."""
    problem = candidate.problem.early
    if len(problem.record.log) < FEWEST:
        problem = candidate.problem
    if problem is candidate.problem:
        problem = replace(problem, record=problem.record.first_part(HEAD))
    if problem.modes != modes:
        problem = replace(problem, modes=modes)
    return replace(candidate, problem=problem)


def _grid(candidate: Candidate) -> list[Point]:
    """Return sizes over the whole range."""
    shares = SHARES if len(candidate.sizes) > 1 else (0.0,)
    return [
        (float(size), share) for size in np.geomspace(*candidate.bounds[candidate.sizes[0]], FIRST) for share in shares
    ]


def _searched(head: Candidate, fine: bool = True) -> tuple[Point, float, float]:
    """Return the point of the lowest score, and the widths of the last pattern around it."""
    points = _grid(head)
    found = [*zip(points, _at(head, points), strict=True)]
    found.sort(key=lambda one: one[1].F)
    kept: list[tuple[Point, Fit]] = []
    for point, fit in found:
        if all(abs(np.log(point[0] / other[0])) > 0.5 for other, _ in kept):
            kept.append((point, fit))
        if len(kept) == KEPT:
            break
    low, high = head.bounds[head.sizes[0]]
    wide = float(np.log(high / low)) / (FIRST - 1) * 0.5
    best = [_followed(head, *one, wide, 0.12, rounds=4) for one in kept]
    point, fit, wide, across = min(best, key=lambda one: one[1].F)
    if fine and fit.F < head.absent.F - ENOUGH:
        point, _, wide, across = _followed(head, point, fit, wide, across, finest=10.0 * FINEST)
    return point, wide, across


def followed_on(fit: Fit) -> Fit:
    """Return a fit of an effect with a hidden mode after patterns of ever smaller width around its values."""
    first, *second = (fit.values[name] for name in fit.candidate.sizes)
    share = second[0] / first if second and first > 0.0 else 0.0
    head = _head(fit.candidate, True)
    (begun,) = _at(head, [(first, share)])
    point, _, wide, across = _followed(head, (first, share), begun, *AROUND, finest=10.0 * FINEST)
    (there,) = _at(fit.candidate, [point])
    if there.F > fit.F:
        point, there, wide, across = (first, share), fit, *AROUND
    return _followed(fit.candidate, point, there, max(wide, LAST), max(across, LAST), rounds=LAST_ROUNDS)[1]


def _at(candidate: Candidate, points: Sequence[Point]) -> list[Fit]:
    return candidate.tried([dict(zip(candidate.sizes, (size, share * size), strict=False)) for size, share in points])


def _followed(
    candidate: Candidate,
    point: Point,
    fit: Fit,
    wide: float,
    across: float,
    rounds: int = 40,
    finest: float = FINEST,
) -> tuple[Point, Fit, float, float]:
    """Return the bottom of the trough around a point, (size, share), the fit there, and the pattern's last widths."""
    low, high = candidate.bounds[candidate.sizes[0]]
    flat = len(candidate.sizes) < 2
    for _ in range(rounds):
        if wide < finest:
            break
        pattern = [(-1.0, 0.0), (1.0, 0.0), (-0.4, 0.0), (0.4, 0.0)]
        if not flat:
            pattern += [(0.0, b) for b in (-1.0, 1.0, 0.4, -0.4)] + [(a, b) for a in (-0.7, 0.7) for b in (-0.7, 0.7)]
        points = [
            (float(np.clip(point[0] * np.exp(wide * a), low, high)), float(np.clip(point[1] + across * b, 0.0, 1.0)))
            for a, b in pattern
        ]
        fits = _at(candidate, points)
        k = int(np.argmin([one.F for one in fits]))
        if fits[k].F < fit.F:
            point, fit = points[k], fits[k]
            wide, across = WIDER * wide, WIDER * across
        else:
            wide, across = SHRINK * wide, SHRINK * across
    return point, fit, wide, across
