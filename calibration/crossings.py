"""How often a signal crosses its mean, and how evenly: a period that needs no cycle to exist."""

import math

import numpy as np
from stickslip.logs.arrays import Values

BAND = 0.35  # of the standard deviation: how far beyond the mean a signal must go to have crossed it
EVEN = 0.35  # spread of the half periods over their mean, at most, in a cycle
CYCLES = 3  # a cycle is seen at least so often


def extent(values: Values) -> float:
    """Return the range of a signal between its quantiles of 0.5 and 99.5 % [its unit]."""
    low, high = np.quantile(values, (0.005, 0.995))
    return float(high - low)


def half_periods(values: Values) -> Values:
    """Return the times between crossings of the mean [samples], with a band against noise.

    >>> import numpy as np
    >>> half_periods(np.sin(np.arange(100.0) * 2 * np.pi / 20)).round().tolist()[:3]
    [10.0, 10.0, 10.0]
    """
    centred = values - values.mean()
    spread = float(centred.std())
    if spread <= 1e-12 * max(1.0, float(np.abs(values).max())):
        return np.zeros(0)
    side = np.where(centred > BAND * spread, 1, np.where(centred < -BAND * spread, -1, 0))
    outside = np.flatnonzero(side)
    signs = side[outside]
    turns = outside[1:][signs[1:] != signs[:-1]]
    return np.asarray(np.diff(turns), dtype=float)


def period(values: Values) -> float:
    """Return twice the mean time between crossings [samples]; NaN for fewer than two crossings."""
    halves = half_periods(values)
    return 2.0 * float(halves.mean()) if len(halves) else math.nan


def even(values: Values) -> bool:
    """Return whether the crossings come at even times, at least ``2 CYCLES`` of them.

    >>> import numpy as np
    >>> even(np.sin(np.arange(200.0) / 4)), even(np.arange(200.0))
    (True, False)
    """
    halves = half_periods(values)
    if len(halves) < 2 * CYCLES:
        return False
    whole = halves[:-1] + halves[1:]
    return bool(whole.std() < EVEN * whole.mean())
