"""Percentiles by partition: what ``numpy.percentile`` and ``numpy.median`` give, without their rounds of checks."""

import numpy as np
from stickslip.logs.arrays import Values


def percentiles(x: Values, *percents: float) -> list[float]:
    """Percentiles [%] of the finite values x (n,), n >= 1, interpolated between neighbours.

    >>> percentiles(np.array([3.0, 1.0, 2.0]), 50.0, 75.0)
    [2.0, 2.5]
    """
    places = [0.01 * percent * (len(x) - 1) for percent in percents]
    lower = [min(int(place), max(len(x) - 2, 0)) for place in places]
    upper = [min(low + 1, len(x) - 1) for low in lower]
    y = np.partition(x, sorted({*lower, *upper}))
    rows = zip(places, lower, upper, strict=True)
    return [float(y[low] + (y[high] - y[low]) * (place - low)) for place, low, high in rows]


def percentile(x: Values, percent: float) -> float:
    """One of ``percentiles``."""
    return percentiles(x, percent)[0]


def median_step(t: Values) -> float:
    """Median of the steps between the times t (n,) [s], n >= 2; of an even clock its step, without a search.

    >>> median_step(np.array([0.0, 1.0, 2.0, 5.0]))
    1.0
    """
    from stickslip.detect.signals.kernels import steps

    low, high = steps(t)
    return low if low == high else percentile(np.diff(t), 50.0)
