"""Fit a stem that takes OP at rows only, and sticks anew at each, where its loop is replayed.

No wrong slip can be set right, as ``replayed_stems`` does, so the trough of the likelihood is narrow.  But it lies
along the two friction bands of ``stickslip.blocks.he_valve``: f_s alone says at which rows the stem slips, f_d where it
stops then.

1. a grid of both on the first part of the record
2. from its best few points lines along each band and along both
3. from the best of these lines over ever smaller ranges, then the same in the whole record
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.likelihood.fit import Fit, refined
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.replayed_stems import head_of
from stickslip.gap.likelihood.settling import free_names

APART, SHARES = 0.07, 10  # of the grid: steps of f_s as a logarithm, and how many shares of it f_d is
KEPT, DISTINCT = 8, 0.15  # points that are followed, and how far apart they are
FURTHER = 3  # of these that are followed over smaller ranges
POINTS = 17  # of a line
WIDE, NARROW = (0.2, 0.1), (0.05, 0.02, 0.01)  # ranges over which bands are sought, up and down, as a share
LAST = (0.1, 0.05, 0.03, 0.01, 0.003)  # the same in the whole record

Bands = tuple[float, float]


def sampled_stem(one: Hypothesis) -> Fit | None:
    """Return the fit of a stem; None if no replay succeeds."""
    free = dict(one.frame.stated)
    head = one.of(replace(one.frame, record=head_of(one)))
    low, high = one.bounds[one.own[0]]
    f_s = np.geomspace(0.5 * low, high, int(math.log(2.0 * high / low) / APART)).tolist()
    grid = [(static, static * part) for static in f_s for part in np.linspace(0.0, 1.0, SHARES).tolist()]
    begun = _apart(sorted(_left(head, free, grid), key=_nll))
    ends = sorted((_followed(head, free, point, WIDE) for point in begun), key=_nll)
    best = min((_followed(head, free, point, NARROW) for point in ends[:FURTHER]), key=_nll, default=None)
    if best is None:
        return None
    found = _followed(one, free, best, LAST)
    return refined(found, free_names(one))


def _followed(one: Hypothesis, free: dict[str, float], best: Innovations, ranges: Sequence[float]) -> Innovations:
    """Return the likeliest of sizes near a start, along one line after the other."""
    for wide in ranges:
        steps = (wide * np.linspace(-1.0, 1.0, POINTS)).tolist()
        for line in (_kinetic, _static, _both):
            tried = [line(*_bands(best), step) for step in steps]
            best = min(_left(one, free, tried), key=_nll, default=best)
    return best


def _kinetic(f_s: float, f_d: float, step: float) -> Bands:
    return f_s, max(f_d + step * f_s, 0.0)


def _static(f_s: float, f_d: float, step: float) -> Bands:
    return f_s * (1.0 + step), f_d


def _both(f_s: float, f_d: float, step: float) -> Bands:
    return f_s * (1.0 + step), f_d * (1.0 + step)


def _left(one: Hypothesis, free: dict[str, float], bands: Sequence[Bands]) -> list[Innovations]:
    """Return what replays of these friction bands leave, without those that cannot be."""
    _, high = one.bounds[one.own[0]]
    sizes = [{"S": f_s + f_d, "J": f_s - f_d} for f_s, f_d in bands if f_d <= f_s and f_s + f_d <= high]
    return [left for left in one.replayed([{**free, **own} for own in sizes]) if left is not None]


def _apart(found: Sequence[Innovations]) -> list[Innovations]:
    """Return the likeliest, which come first, that are distinct."""
    kept: list[Innovations] = []
    for left in found:
        if len(kept) < KEPT and all(_distance(left, other) > DISTINCT for other in kept):
            kept.append(left)
    return kept


def _distance(one: Innovations, other: Innovations) -> float:
    """Return the larger difference of their bands, as a share of f_s."""
    (f_s, f_d), (s, d) = _bands(one), _bands(other)
    return max(abs(math.log(f_s / s)), abs(f_d - d) / max(f_s, s))


def _bands(found: Innovations) -> Bands:
    S, J = found.values["S"], found.values["J"]
    return 0.5 * (S + J), 0.5 * (S - J)


def _nll(found: Innovations) -> float:
    return found.nll
