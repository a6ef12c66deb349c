"""The normal law behind spreads and intervals: what a median says of a standard deviation, and how wide 90 % are."""

import numpy as np
from stickslip.logs.arrays import Values

Z90 = 1.645  # standard deviations on either side that hold 90 % of a normal law
OF_MEDIAN = 1.2533  # standard error of a median over that of a mean
OF_SIZES = 1.4826  # standard deviation over the median size
OF_QUARTILES = 1.0 / 1.349  # the same over the distance of the quartiles


def spread(x: Values) -> float:
    """Return the standard deviation of normal values about zero, by their median size: outliers count for nothing.

    >>> round(spread(np.array([-1.0, 1.0, -1.0, 1.0, 50.0])), 4)
    1.4826
    """
    return OF_SIZES * float(np.median(np.abs(x)))


def spread_about(x: Values) -> float:
    """Return the same of values about their median."""
    return spread(x - np.median(x))


def half_of_median(x: Values, known_to: float = 0.0) -> float:
    """Return half of the 90 % interval of a median, by the quartiles; each value is ``known_to`` so much at best."""
    quartiles = float(np.percentile(x, 75) - np.percentile(x, 25)) * OF_QUARTILES
    return Z90 * OF_MEDIAN * float(np.hypot(quartiles, known_to)) / float(np.sqrt(len(x)))
