"""When a signal changes sign for good, whatever noise does to it in between."""

import numpy as np
from stickslip.logs.arrays import Values


def crossings(t: Values, x: Values, band: float | Values = 0.0) -> Values:
    """Times [s] at which x changes sign for good, shape (m,).

    A change counts when x leaves -band on one side and +band on the other (hysteresis; one band for all samples or one
    for each). Between the two the noisy signal may cross zero several times; the middle between its first and last
    crossing is taken.

    >>> crossings(np.array([0.0, 1, 2, 3]), np.array([-1.0, 1, 3, -1])).tolist()
    [0.5, 2.75]
    """
    from stickslip.detect.signals.kernels import flips

    times = np.empty(len(x))
    bands = np.full(len(x), band, dtype=float) if np.ndim(band) == 0 else np.ascontiguousarray(band, dtype=float)
    return times[: flips(np.ascontiguousarray(t), np.ascontiguousarray(x), bands, times)].copy()
