"""Look for the size of an effect over its whole range.

Innovations are smooth functions of an effect's size where their score is not: between neighbouring sizes they are
interpolated, so that the narrow trough of the score is found from few replays.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from stickslip.gap.fits.search import SETTLED, Candidate, Fit, best_of, refined
from stickslip.gap.floors.floor import losses

NODES = 6  # sizes of a parameter that are replayed first
MORE = 2  # and more on the first part of the record, which costs little
NODES_OF_FILTER = 9  # where a filter makes the residuals, which costs little
BETWEEN = 8  # sizes looked at between two that were replayed
MILD = 2  # sizes of a limit that are replayed where the gap is small


def between(fits: Sequence[Fit], name: str) -> tuple[float, float]:
    """Return (value, F) where interpolated innovations of fits that differ in one parameter score best."""
    ordered = sorted(fits, key=lambda fit: fit.values[name])
    best = min((fit.F, fit.values[name]) for fit in ordered)
    for one, other in pairwise(ordered):
        a, b = one.values[name], other.values[name]
        if min(one.F, other.F) > 3.0 * best[0] or not math.isfinite(b - a):
            continue
        for share in np.linspace(0.0, 1.0, BETWEEN + 2)[1:-1]:
            F = float(losses(one.e + share * (other.e - one.e)).sum())
            if best[0] > F:
                best = F, a + share * (b - a)
    return best[1], best[0]


def fitted(candidate: Candidate, nodes: int = 0) -> Fit | None:
    """Return the fit of an effect over the whole range of each size, one after the other; None if no run succeeded.

    Signed ranges that are linear are gone through in both directions from neutral, near it in smaller steps.  Where the
    first part of the record shows the gap, sizes are tried there, and the best of them on the whole.  ``nodes`` sizes
    of each, by default as many as the way of making residuals affords.
    """
    nodes = nodes or (NODES if candidate.problem.record.filter is None else NODES_OF_FILTER)
    early = candidate.problem.early
    if early is candidate.problem:
        return _over_range(candidate, nodes)
    first = _over_range(replace(candidate, problem=early), nodes + MORE)
    if first is None or not first.present:
        return candidate.absent
    first = refined(first, 2)  # between two nodes the score may be as if nothing were explained
    return best_of([candidate.absent, *candidate.tried([first.values])])


def _near_neutral(best: Fit | None) -> Fit | None:
    """Return a small size where none of the range suits: what the slope at neutral leads to."""
    return best if best is None or best.present else refined(best, 2)


def _over_range(candidate: Candidate, nodes: int) -> Fit | None:
    effect = candidate.effect
    if effect is None:
        return candidate.absent
    values = dict(candidate.nominal)
    best: Fit | None = None
    for p in effect.parameters:
        if p.nuisance:
            continue
        low, high = candidate.bounds[p.name]
        nominal = candidate.nominal[p.name]
        grid = _grid(p.spacing, low, high, nominal, nodes)
        if not math.isfinite(nominal) and candidate.problem.score <= candidate.problem.limit:
            grid = sorted(grid, reverse=nominal > 0.0)[:MILD]  # what does not show by itself is small
        fits = [fit for fit in candidate.tried([{**values, p.name: size} for size in grid]) if math.isfinite(fit.F)]
        if best is not None:
            fits.append(best)
        elif math.isfinite(nominal):
            fits.append(candidate.absent)
        if not fits:
            continue
        size, F = between(fits, p.name)
        best = best_of(fits)
        if best is not None and F < best.F - SETTLED:
            best = best_of([best, *candidate.tried([{**values, p.name: size}])])
        if best is not None:
            values = dict(best.values)
    return _near_neutral(best)


def _grid(spacing: str, low: float, high: float, nominal: float, nodes: int) -> list[float]:
    """Return sizes to try first: evenly, or in their logarithm, or to both sides of neutral in a geometric series."""
    if spacing == "log":
        return [float(v) for v in np.geomspace(low, high, nodes) if v != nominal]
    if math.isfinite(nominal) and low < nominal < high:
        share = np.geomspace(0.01, 1.0, (nodes + 1) // 2)
        return [*(nominal + share * (high - nominal)).tolist(), *(nominal + share * (low - nominal)).tolist()]
    return [float(v) for v in np.linspace(low, high, nodes) if v != nominal]
