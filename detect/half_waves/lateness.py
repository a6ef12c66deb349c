"""How late the peaks of half cycles are: the area ratio of all of them, its interval, and of either half wave.

    R = sum A1 / sum A2

A1 and A2 are the areas before and after the peak of each half cycle. The half cycles are weighed anew for the interval.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from stickslip.detect.half_waves.half_cycles import HalfCycle
from stickslip.detect.signals.bootstrap import interval


class Side(NamedTuple):
    """R of one half wave [-] and the number of its half cycles."""

    R: float
    half_cycles: int


class Lateness(NamedTuple):
    """R of all half cycles, the bounds of its interval, and "above" and "below": the half waves by where PV is.

    A half wave without half cycles is left out of ``sides``.
    """

    R: float
    low: float
    high: float
    sides: dict[str, Side]


def lateness(half_cycles: Sequence[HalfCycle], resamples: int, seed: int, coverage: float) -> Lateness:
    """R of half cycles of e = SP - PV, which is negative while PV is above SP.

    >>> half = HalfCycle(0, 3, 4, 1.0, area_before=3.0, area_after=1.0, samples=9, sine_misfit=0, triangle_misfit=0)
    >>> found = lateness([half, half], 100, 0, 0.9)
    >>> found.R, round(found.low, 9), round(found.high, 9), found.sides
    (3.0, 3.0, 3.0, {'below': Side(R=3.0, half_cycles=2)})
    """
    before = np.array([half.area_before for half in half_cycles])
    after = np.array([half.area_after for half in half_cycles])
    peak = np.array([half.peak for half in half_cycles])
    areas = np.column_stack([before, after])
    low, high = interval(lambda means: np.asarray(means[..., 0] / means[..., 1]), areas, coverage, resamples, seed)
    sides = {
        name: Side(float(before[side].sum() / after[side].sum()), int(side.sum()))
        for name, side in (("above", peak < 0), ("below", peak > 0))
        if side.any()
    }
    return Lateness(float(before.sum() / after.sum()), low, high, sides)


def closed_form(h: float) -> float:
    """R of a square wave through a first-order lag, h = (half period) / tau [-].

        a = tanh(h / 2),    R = (h - ln(1 + a) - a) / (a - ln(1 + a))

    >>> round(closed_form(25 / 8), 2), round(closed_form(1e-3), 2)
    (5.87, 1.0)
    """
    a = math.tanh(h / 2)
    return (h - math.log1p(a) - a) / (a - math.log1p(a))


def lag_of(R: float, half_period: float) -> float:
    """Time constant [s] behind which a square wave of this half period [s] has this R [-], rounded to two digits.

    It is sought between a tenth of the half period and twenty times it; R rises as the lag falls.

    >>> lag_of(1.92, 25.0), lag_of(1.0, 25.0)
    (25.0, 500.0)
    """
    h = np.geomspace(0.05, 10.0, 500)
    tau = half_period / float(np.interp(R, [closed_form(float(value)) for value in h], h))
    return round(tau, 1 - math.floor(math.log10(tau)))
