"""Fit an effect with a hidden mode, such as a stem that sticks: its score has many troughs and one deep, narrow one.

A grid over both sizes, the second as a share of the first; then patterns of points around the best few, ever smaller.
"""

from collections.abc import Sequence

import numpy as np

from diagram.diagram import Diagram
from gap.effect import Effect
from gap.problem import Problem
from gap.search import Fit, tried

FIRST = 14  # sizes of the first parameter
SHARES = (0.0, 0.12, 0.25, 0.4, 0.6, 0.85)  # the second as a share of the first
KEPT = 3  # troughs that are followed
SHRINK = 0.55  # of a pattern from round to round
FINEST = 5e-4  # relative size of the last pattern


def fitted_hidden(problem: Problem, base: Diagram, effect: Effect, place: str) -> Fit | None:
    """Return the best fit of an effect with a hidden mode; None if no run succeeded."""
    names = [p.name for p in effect.parameters]
    bounds = effect.bounds(base, place)
    first = np.geomspace(*bounds[names[0]], FIRST)
    shares = SHARES if len(names) > 1 else (0.0,)
    points = [(float(size), share) for size in first for share in shares]
    found = [*zip(points, _at(problem, base, effect, place, points), strict=True)]
    found.sort(key=lambda one: one[1].F)
    kept: list[tuple[tuple[float, float], Fit]] = []
    for point, fit in found:
        if all(abs(np.log(point[0] / other[0])) > 0.5 for other, _ in kept):
            kept.append((point, fit))
        if len(kept) == KEPT:
            break
    wide = float(np.log(first[1] / first[0])) * 0.5
    best = [_followed(problem, base, effect, place, *one, wide, 0.12) for one in kept[:1]]
    for point, fit in kept[1:]:  # a second trough is followed a little, and further only if it is as deep
        best.append(_followed(problem, base, effect, place, point, fit, wide, 0.12, rounds=3))
    best.sort(key=lambda one: one[1].F)
    point, fit = best[0]
    if fit is not None and len(best) > 1:
        point, fit = _followed(problem, base, effect, place, point, fit, wide * SHRINK**3, 0.12 * SHRINK**3)
    return fit if np.isfinite(fit.F) else None


def _at(
    problem: Problem, base: Diagram, effect: Effect, place: str, points: Sequence[tuple[float, float]]
) -> list[Fit]:
    names = [p.name for p in effect.parameters]
    many = [dict(zip(names, (size, share * size), strict=False)) for size, share in points]
    return tried(problem, base, effect, place, many)


def _followed(
    problem: Problem, base: Diagram, effect: Effect, place: str, point: tuple[float, float], fit: Fit, wide: float,
    across: float, rounds: int = 40,
) -> tuple[tuple[float, float], Fit]:  # fmt: skip
    """Return the bottom of the trough around a point: (size, share) and the fit there."""
    low, high = effect.bounds(base, place)[effect.parameters[0].name]
    flat = len(effect.parameters) < 2
    for _ in range(rounds):
        if wide < FINEST:
            break
        pattern = [(-1, 0), (1, 0), (-0.4, 0), (0.4, 0)]
        if not flat:
            pattern += [(0, -1), (0, 1), (0, 0.4), (0, -0.4), (-0.7, 0.7), (0.7, 0.7), (-0.7, -0.7), (0.7, -0.7)]
        points = [
            (float(np.clip(point[0] * np.exp(wide * a), low, high)), float(np.clip(point[1] + across * b, 0.0, 1.0)))
            for a, b in pattern
        ]
        fits = _at(problem, base, effect, place, points)
        k = int(np.argmin([one.F for one in fits]))
        if fits[k].F < fit.F:
            point, fit = points[k], fits[k]
            wide, across = 0.8 * wide, 0.8 * across
        else:
            wide, across = SHRINK * wide, SHRINK * across
    return point, fit
