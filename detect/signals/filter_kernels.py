"""The compiled loops of ``filters``, in a file of their own so that the compiler is loaded when one runs."""

import numpy as np
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")
def low_passed(x, b, a_1, a_2):  # type: ignore[no-untyped-def]
    """Filter x, as if it had stood at its first value before."""
    y = np.empty(len(x))
    first, second = x[0] * (1.0 - b), x[0] * (b - a_2)
    for n in range(len(x)):
        y[n] = b * x[n] + first
        first = 2.0 * b * x[n] - a_1 * y[n] + second
        second = b * x[n] - a_2 * y[n]
    return y


@njit(cache=True, error_model="numpy")
def passed(x, b_0, b_1, a_1):  # type: ignore[no-untyped-def]
    """Filter each row of x (rows, n), at rest before."""
    y = np.empty(x.shape)
    for row in range(x.shape[0]):
        kept = 0.0
        for n in range(x.shape[1]):
            y[row, n] = b_0 * x[row, n] + kept
            kept = b_1 * x[row, n] - a_1 * y[row, n]
    return y
