"""Half cycles of an oscillating signal: where it crosses its centre, where it peaks, the area on either side.

Crossings and peaks lie between samples; both are interpolated, and the areas are cut there:

    A1 = area from the zero crossing to the peak,    A2 = area from the peak to the next crossing

Works on uneven sampling throughout: areas are trapezoids of the polygon through the samples, the interpolated
crossings and the interpolated peak.
"""

from itertools import starmap
from typing import NamedTuple

import numpy as np
from stickslip.logs.arrays import Indices, Values

FLAT_SHARE = 0.6  # a sine spends 29 % of its half period above 90 % of its peak, a triangle 10 %, a square 100 %
TWO_PEAKS_SHARE = 0.2  # tops apart by more than this share of the half cycle are two peaks
KINK = 1.8  # slope break at a corner over the break that smooth curvature beside it explains (1 = smooth)
SAMPLES_MIN = 5


class HalfCycle(NamedTuple):
    """One half cycle between two zero crossings.

    start, peak_time, end : float [s]
    peak : signed height [unit of the signal]
    area_before, area_after : A1 and A2, both positive [unit s]
    samples : samples between the crossings
    sine_misfit, triangle_misfit : squared distance to the best sine and the best triangle on the same base [unit^2 s]
    fault : "" or why it cannot be used: "short", "flat", "two_peaks", "length", "low", "gap"
    """

    start: float
    peak_time: float
    end: float
    peak: float
    area_before: float
    area_after: float
    samples: int
    sine_misfit: float
    triangle_misfit: float
    fault: str = ""

    @property
    def length(self) -> float:
        """Time between the crossings [s]."""
        return self.end - self.start


def in_pieces(
    t: Values, x: Values, bounds: Indices, periods: Values, smooth_max: float, noise_share: float,
    drift_share: float,
) -> tuple[list[HalfCycle], Values, bool]:  # fmt: skip
    """The half cycles of the pieces of x (n,) between ``bounds`` (m + 1,), made ready as the module of ``cycles`` says.

    Returns them, the prepared x (n,), and whether a drift came off any piece.  ``periods`` (m,) [s] are those of the
    pieces, the shares those of ``cycles.Params``.  A crossing is firm beyond a tenth of the standard deviation or
    three times the noise left.  A half cycle that is not a quarter to a whole period long has the fault "length", one
    whose peak lies below half of the standard deviation the fault "low".
    """
    from stickslip.detect.half_waves.cycle_kernels import all_pieces
    from stickslip.detect.half_waves.half_cycle_kernels import FAULTS

    e, drifts, rows = all_pieces(
        np.ascontiguousarray(t), np.ascontiguousarray(x), bounds, periods, smooth_max, noise_share,
        drift_share, SAMPLES_MIN, FLAT_SHARE, TWO_PEAKS_SHARE, KINK,
    )  # fmt: skip
    fault, when, peak, before, after, n, sine, triangle, start, end = rows.T
    columns = (start, when, end, peak, before, after, n.astype(int), sine, triangle)
    faults = [FAULTS[k] for k in fault.astype(int).tolist()]
    found = list(starmap(HalfCycle, zip(*(column.tolist() for column in columns), faults, strict=True)))
    return found, e, bool(drifts)
