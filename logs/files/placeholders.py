"""Numbers that stand where there is no number: -999, -9999, 9999999, the ends of a computer's number, 1e31."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

__all__ = ["placeholders"]

Values = npt.NDArray[np.float64]

_NINES = np.array([10.0**n - 1.0 for n in range(3, 16)])
# Null values of logged data (LAS), and nines with decimals.
_OTHERS = np.array([999.25, 9999.25, 999.9, 999.99, 9999.9, 9999.99, 99999.99])
_ENDS = np.array([2.0**n for n in (15, 31, 63)] + [2.0**n - 1.0 for n in (15, 16, 31, 32)])
_KNOWN = np.unique(np.concatenate([_NINES, _OTHERS, _ENDS]))
_HUGE = 1e20  # no measurement is as large, in any unit
# Times the largest of the other values, for a repeated negative number where none of these is negative.  What lies as
# far and comes once is told, and kept.
_BELOW = 2.0
_FAR = 20.0  # times the largest of the other values, otherwise: also for what comes once


def placeholders(values: Values) -> list[tuple[float, int, bool]]:
    """Numbers of such a form that lie far outside the other values, how often they come, and whether they are none.

    What lies nearer may be measured, as a gauge at its end is; so may what comes once, unless it is farther still.

    >>> placeholders(np.array([4.0, 5.0, -999.0, 4.5, -999.0, 1e31]))
    [(-999.0, 2, True), (1e+31, 1, True)]
    >>> placeholders(np.array([100.0, 105.0, -999.0, 103.0]))
    [(-999.0, 1, False)]
    >>> placeholders(np.array([900.0, 950.0, 999.0, 999.0]))
    []
    """
    size = np.abs(values)
    known = size >= 999.0
    if not known.any():  # nearly every column
        return []
    known &= np.isin(size, _KNOWN) | (size >= _HUGE)
    if not known.any():
        return []
    rest = values[np.isfinite(values) & ~known]
    if len(rest) == 0:
        return []
    largest, negative = float(np.abs(rest).max()), bool((rest < 0).any())
    found = []
    for number, count in zip(*np.unique(values[known], return_counts=True), strict=True):
        opposite = number < 0 and not negative
        times = _BELOW if opposite and count > 1 else _FAR
        far = abs(number) >= times * largest and (largest > 0 or opposite)
        sure = bool(far or abs(number) >= _HUGE)
        if sure or (count == 1 and abs(number) >= _BELOW * largest > 0.0):
            found.append((float(number), int(count), sure))
    return found
