"""The filters of the methods, and summits: what they need of a library of signals that takes half a second to load.

    low pass     second order, Butterworth: k = tan(pi c / 2), c the cut over the Nyquist frequency,
                 b = (1, 2, 1) k^2 / (1 + sqrt(2) k + k^2),   a = (1, 2 (k^2 - 1), 1 - sqrt(2) k + k^2) / (...)
    first order  y_n = b_0 x_n + b_1 x_{n-1} - a_1 y_{n-1}, at rest before

Source: Oppenheim and Schafer 2010; forwards and backwards: Gustafsson 1996, with ends mirrored through the end point.
"""

import math

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values

EDGE_SAMPLES = 9  # samples mirrored at each end


def smoothed(x: Values, cut: float) -> Values:
    """Return x (n,), n > 9, low-passed forwards and backwards, hence without phase; ``cut`` over the Nyquist frequency.

    >>> ripple = np.tile([2.0, 4.0], 100)
    >>> smoothed(ripple, 0.2)[99:101].round(9).tolist()
    [3.0, 3.0]
    """
    from stickslip.detect.signals.filter_kernels import low_passed

    k = math.tan(0.5 * math.pi * cut)
    whole = 1.0 + math.sqrt(2.0) * k + k * k
    b, a_1, a_2 = k * k / whole, 2.0 * (k * k - 1.0) / whole, (1.0 - math.sqrt(2.0) * k + k * k) / whole
    long = np.concatenate([2.0 * x[0] - x[EDGE_SAMPLES:0:-1], x, 2.0 * x[-1] - x[-2 : -EDGE_SAMPLES - 2 : -1]])
    forwards = low_passed(long, b, a_1, a_2)
    return np.asarray(low_passed(forwards[::-1].copy(), b, a_1, a_2)[::-1][EDGE_SAMPLES:-EDGE_SAMPLES])


def first_order(x: Values, b_0: float, b_1: float, a_1: float) -> Values:
    """Return the rows of x (..., n) through the filter of first order of the module.

    >>> first_order(np.array([1.0, 0.0, 0.0]), 1.0, 0.0, -0.5).tolist()
    [1.0, 0.5, 0.25]
    """
    from stickslip.detect.signals.filter_kernels import passed

    rows = np.ascontiguousarray(x, dtype=float)
    return np.asarray(passed(rows.reshape(-1, rows.shape[-1]), b_0, b_1, a_1).reshape(rows.shape))


def summits(x: Values, room: int) -> NDArray[np.intp]:
    """Return where x (n,) has summits at least ``room`` samples apart, higher ones first to be taken; flat tops once.

    >>> summits(np.array([0.0, 2.0, 0.0, 3.0, 3.0, 3.0, 0.0, 1.0]), 1).tolist()
    [1, 4]
    >>> summits(np.array([0.0, 2.0, 0.0, 3.0, 3.0, 3.0, 0.0, 1.0]), 4).tolist()
    [4]
    """
    first = np.flatnonzero(np.concatenate([[True], x[1:] != x[:-1]]))
    last = np.concatenate([first[1:], [len(x)]]) - 1
    level = x[first]
    top = 1 + np.flatnonzero((level[1:-1] > level[:-2]) & (level[1:-1] > level[2:]))
    places = (first[top] + last[top]) // 2
    taken: list[int] = []
    free = np.ones(len(places), dtype=bool)
    for j in np.argsort(x[places])[::-1]:
        if free[j]:
            taken.append(int(places[j]))
            near = slice(*np.searchsorted(places, [places[j] - room + 1, places[j] + room]))
            free[near] = False
    return np.array(sorted(taken), dtype=np.intp)
