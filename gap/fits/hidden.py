"""Fit an effect with a hidden mode, such as a stem that sticks: its score has many troughs and one deep, narrow one.

1. A grid over both sizes, the second as a share of the first, and patterns of points around the best few, on the first
   part of the record, with the modes as the replay has them, which makes the deep trough wide.  Where the stem itself
   is logged its sizes are read off its figure (``figure``).  Where that is not good, each row puts it right, and the
   best such replay may be one whose stem never moves by itself: there a second search has wrong modes set right from
   the beginning.
2. From its bottom patterns, ever smaller, with wrong modes set right, which tells where replays of the true sizes go
   wrong.  Modes set right repair wrong sizes as well, by many more of them, so here each costs more.
3. Where the modes are right innovations have slopes: steps along these on the whole record, and patterns only where
   they leave something.

A filter of a large diagram has no modes to set right: there the first patterns are followed, then those of the whole.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.gap.fits.figure import read_off
from stickslip.gap.fits.robust import step
from stickslip.gap.fits.search import Candidate, Fit, best_of, refined
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.paths import given

Floats = NDArray[np.float64]
FIRST = 14  # sizes of the first parameter
SHARES = (0.0, 0.12, 0.25, 0.4, 0.6, 0.85)  # the second as a share of the first
KEPT, APART = 4, 0.3  # troughs that are followed, and how far apart their first sizes are, as a logarithm
HINT = 0.1  # share of what the first part shows that a size of the grid explains before its neighbourhood is looked at
BEGUN, SAME = 2, 0.03  # troughs from which modes are set right; nearer ones have run into each other
SHOWS = 0.3  # share of what the first part shows that the search explains before wrong modes are set right
DEARER = 4.0  # times their charge that modes set right cost besides, in the search
SHRINK = 0.55  # of a pattern from round to round
FINEST = 2e-4  # relative size of the last pattern
ENOUGH = 50.0  # nats that the first part of the record must gain by the effect
HEAD = 0.4  # share of the record that is enough for the search where its first part does not show the gap
FEWEST = 1200  # rows of a first part that show enough slips
WORTH, CLEAN = 0.75, 0.9  # share of the gap from which on, up to which patterns are followed on the whole record
LAST, LAST_ROUNDS = 0.005, 6  # least width of the first pattern there, and how many there are
WORTH_BETWEEN, ROUNDS_BETWEEN = 0.2, 12  # the same share and number where a filter makes the residuals
PLACES = 2  # at which hidden modes are looked for where a filter has told which promise most
AROUND = 0.1, 0.1  # first widths of a pattern around values that are nearly right
READ, GOOD = (0.03, 0.05), 0.85  # the same around values read off a log; share that is explained if it was a stem's
WIDER = 0.9  # of a pattern that has moved

# of points around the best, as shares of their widths; the second half where the first is no better
PATTERNS = (
    ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, 0.7), (-0.7, -0.7)),
    ((-0.4, 0.0), (0.4, 0.0), (0.0, -0.4), (0.0, 0.4), (0.7, -0.7), (-0.7, 0.7)),
)
PATTERNS_FLAT = (((-1.0, 0.0), (1.0, 0.0), (-0.4, 0.0), (0.4, 0.0)),)

Lines = tuple[Floats, Floats, Floats]  # slopes (values, sizes), and how far each size may go down and up
Point = tuple[float, float]  # the first size, and the second as a share of it


def fitted_hidden(candidate: Candidate) -> Fit | None:
    """Return the best fit of an effect with a hidden mode; None if no run succeeded."""
    ends = _read(candidate)
    if not ends:
        logged = given(candidate.problem.model, candidate.place) in candidate.problem.record.pinned
        ends = [_searched(candidate, modes) for modes in ((False, True) if logged else (False,))]
    fits = _at(candidate, [point for point, _, _ in ends])
    fit = best_of(fits)
    if fit is None:
        return None
    _, wide, across = ends[fits.index(fit)] if len(fits) == len(ends) else ends[0]
    if _filtered(candidate):
        near, rounds = _share(fit) >= WORTH_BETWEEN, ROUNDS_BETWEEN
    else:
        fit = refined(fit)
        near, rounds = WORTH <= _share(fit) < CLEAN, LAST_ROUNDS
    if not near:  # far from anything that could be named, alone or beside another, or there
        return fit
    return _followed(candidate, _point(fit), fit, max(wide, LAST), max(across, LAST), rounds=rounds)[1]


def _read(candidate: Candidate) -> list[tuple[Point, float, float]]:
    """Return the point that the log of the stem itself shows, and widths of a pattern there; none if it is not good."""
    points = [] if _filtered(candidate) else read_off(candidate)
    begun = min(_at(_head(candidate, True), points), key=_cost, default=None)
    if begun is None:
        return []
    point, fit, wide, across = _followed(begun.candidate, _point(begun), begun, *READ, finest=10.0 * FINEST)
    return [(point, wide, across)] if _share(fit) >= GOOD else []


def glimpsed(candidate: Candidate) -> Fit | None:
    """Return the best fit of an effect with a hidden mode, searched coarsely on the first part of the record."""
    point, _, _ = _searched(candidate, False)
    return best_of(_at(candidate, [point]))


@dataclass(frozen=True, eq=False)
class Trough:
    """``sizes`` of an effect with a hidden mode; ``moved`` by how much those of another move there, along lines, and
    ``F`` the score that is left then.
    """

    sizes: dict[str, float]
    moved: Floats
    F: float


def glimpsed_beside(candidate: Candidate, lines: Lines) -> list[Trough]:
    """Return the best minima of an effect with a hidden mode together with another effect, the deepest first.

    Sizes of the other that were found alone make up for the stem, and a replay with them has no trough for it: so each
    size of the grid is judged by what ``lines`` of the other leave of its innovations on the first part of the record.
    """
    head = _head(candidate, False)
    J, low, high = lines
    if not J.shape[1]:
        return []
    fits = _on_grid(head)
    steps = {id(fit): step(fit.e.ravel(), J, low, high) for fit in fits}
    ordered = _apart(sorted(fits, key=lambda fit: steps[id(fit)][1]))
    return [Trough({k: fit.values[k] for k in fit.candidate.own}, *steps[id(fit)]) for fit in ordered]


def _filtered(candidate: Candidate) -> bool:
    return candidate.problem.record.filter is not None


def _share(fit: Fit) -> float:
    """Return the share of what there is without the effect that a fit explains."""
    absent = fit.candidate.absent.F
    if not fit.e.size:  # a log of which no row is scored
        return 0.0
    level = fit.candidate.problem.floor.mean * float(np.isfinite(fit.e).mean()) * len(fit.e)
    return (absent - fit.F) / max(absent - level, 1e-9)


def _point(fit: Fit) -> Point:
    """Return the first size of a fit, and the second as a share of it."""
    first, *second = (fit.values[name] for name in fit.candidate.sizes)
    return first, second[0] / first if second and first > 0.0 else 0.0


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
    return replace(candidate, problem=first_part_of(candidate.problem, modes))


@lru_cache(maxsize=8)
def first_part_of(whole: Problem, modes: bool) -> Problem:
    """Return the problem of the first part of a record; the same one again for the next candidate."""
    problem = whole.early
    if len(problem.record.log) < FEWEST:
        problem = whole
    if problem is whole:
        problem = replace(problem, record=problem.record.first_part(HEAD))
    return problem if problem.modes == modes else replace(problem, modes=modes)


def _grid(candidate: Candidate) -> list[Point]:
    """Return sizes over the whole range."""
    shares = SHARES if len(candidate.sizes) > 1 else (0.0,)
    return [
        (float(size), share) for size in np.geomspace(*candidate.bounds[candidate.sizes[0]], FIRST) for share in shares
    ]


def _on_grid(candidate: Candidate) -> Sequence[Fit]:
    """Return the fits at sizes over the whole range; the same ones again where they are judged beside others."""
    assert candidate.effect is not None
    return _replayed_on_grid(candidate.problem, candidate.base, candidate.effect, candidate.place)


@lru_cache(maxsize=2)
def _replayed_on_grid(problem: Problem, base: Diagram, effect: Effect, place: str) -> tuple[Fit, ...]:
    candidate = Candidate(problem, base, effect, place)
    return tuple(_at(candidate, _grid(candidate)))


def _searched(candidate: Candidate, modes: bool) -> tuple[Point, float, float]:
    """Return the point of the lowest score on the first part of the record, and the last widths of a pattern there.

    ``modes``: wrong ones are set right from the beginning.
    """
    head = _head(candidate, modes)
    low, high = head.bounds[head.sizes[0]]
    wide = float(np.log(high / low)) / (FIRST - 1) * 0.5
    fits = sorted(_on_grid(head), key=_cost)
    if _share(fits[0]) < HINT and not _filtered(candidate):
        return _point(fits[0]), wide, 0.12
    ends = [(_point(fit), fit, wide, 0.12) for fit in _apart(fits)]
    for few in (len(ends), BEGUN):  # two rounds for each, two more for the best
        ends[:few] = [_followed(head, *end, rounds=2) for end in ends[:few]]
        ends.sort(key=lambda one: _cost(one[1]))
    point, fit, wide, across = ends[0]
    if fit.F >= head.absent.F - ENOUGH:
        return point, wide, across
    if _filtered(candidate):
        point, _, wide, across = _followed(head, point, fit, wide, across, finest=10.0 * FINEST)
        return point, wide, across
    best: tuple[Point, Fit, float, float] | None = None
    for fit in _apart([end[1] for end in ends[:BEGUN]], SAME):
        if _share(fit) < SHOWS or (best is not None and _share(best[1]) >= CLEAN):
            break
        point = _point(fit)
        (begun,) = _at(_head(candidate, True), [point])
        found = _followed(begun.candidate, point, begun, *AROUND, finest=10.0 * FINEST)
        if best is None or _cost(found[1]) < _cost(best[1]):
            best = found
    point, _, wide, across = best or ends[0]
    return point, wide, across


def _apart(fits: Sequence[Fit], least: float = APART) -> list[Fit]:
    """Return the best of fits, which are in order, that lie in troughs of their own: first sizes ``least`` apart."""
    kept: list[Fit] = []
    for fit in fits:
        if all(abs(np.log(_point(fit)[0] / _point(other)[0])) > least for other in kept):
            kept.append(fit)
    return kept[:KEPT]


def followed_on(fit: Fit) -> Fit:
    """Return a fit of an effect with a hidden mode after steps along slopes, and where these leave something patterns
    of ever smaller width on the first part of the record and steps again.
    """
    fit = refined(fit)
    if _share(fit) >= CLEAN:
        return fit
    head = _head(fit.candidate, True)
    point = _point(fit)
    (begun,) = _at(head, [point])
    there = best_of(_at(fit.candidate, [_followed(head, point, begun, *AROUND, finest=10.0 * FINEST)[0]]))
    return fit if there is None else best_of([fit, refined(there)]) or fit


def patterned(fit: Fit, wide: float, rounds: int) -> Fit:
    """Return a fit of an effect with a hidden mode after patterns of sizes, the first of relative width ``wide``."""
    return _followed(fit.candidate, _point(fit), fit, wide, 2.0 * wide, rounds=rounds)[1]


def _cost(fit: Fit) -> float:
    """Return what the search goes by: modes that are set right cost more there, because they repair wrong sizes too."""
    return fit.F + DEARER * fit.charge


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
        moved = False
        for pattern in PATTERNS_FLAT if flat else PATTERNS:
            points = [
                (
                    float(np.clip(point[0] * np.exp(wide * a), low, high)),
                    float(np.clip(point[1] + across * b, 0.0, 1.0)),
                )
                for a, b in pattern
            ]
            fits = _at(candidate, points)
            k = int(np.argmin([_cost(one) for one in fits]))
            moved = _cost(fits[k]) < _cost(fit)
            if moved:
                point, fit = points[k], fits[k]
                break
        less = WIDER if moved else SHRINK
        wide, across = less * wide, less * across
    return point, fit, wide, across
