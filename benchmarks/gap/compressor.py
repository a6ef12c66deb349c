"""The historian of the benchmark: a swinging door, written on its own.

A point is kept as soon as no straight line from the last kept one passes all samples since within the deviation; what
is kept then is the sample before.  The samples in between come back on straight lines.
"""

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


def doors(t: Values, y: Values, deviation: float) -> Values:
    """Return a signal as it comes back from the archive."""
    kept, pivot = [0], 0
    lower, upper = -np.inf, np.inf
    for i in range(1, len(t)):
        through = (y[i] - y[pivot]) / (t[i] - t[pivot])
        if through < lower or through > upper:
            pivot = i - 1
            kept.append(pivot)
            lower, upper = -np.inf, np.inf
        lower = max(lower, (y[i] - deviation - y[pivot]) / (t[i] - t[pivot]))
        upper = min(upper, (y[i] + deviation - y[pivot]) / (t[i] - t[pivot]))
    kept.append(len(t) - 1)
    return np.interp(t, t[kept], y[kept])
