"""The order of samples, compiled: places on a clock, and the median.

Loaded when first called.  Numpy's own functions give the same; code that calls them loads numba's whole linear algebra
to run, a tenth of what a check of one loop costs.
"""

from typing import Any

import numpy as np
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def count_before(t: Any, when: float) -> int:
    """How many of the rising t (n,) are before ``when``."""
    low, high = 0, len(t)
    while low < high:
        middle = (low + high) // 2
        if t[middle] < when:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def count_until(t: Any, when: float) -> int:
    """How many of the rising t (n,) are not after ``when``."""
    low, high = 0, len(t)
    while low < high:
        middle = (low + high) // 2
        if t[middle] <= when:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def median(x: Any) -> Any:
    """Median of x (n,), n >= 1, which changes its order (quickselect: Hoare, Communications of the ACM, 1961)."""
    n = len(x)
    half, low, high = n // 2, 0, n - 1
    while low < high:
        pivot, i, j = x[(low + high) // 2], low, high
        while i <= j:
            while x[i] < pivot:
                i += 1
            while x[j] > pivot:
                j -= 1
            if i <= j:
                x[i], x[j] = x[j], x[i]
                i, j = i + 1, j - 1
        if half <= j:
            high = j
        elif half >= i:
            low = i
        else:
            break
    if n % 2:
        return x[half]
    below = x[0]
    for k in range(1, half):
        below = max(below, x[k])
    return (below + x[half]) / 2


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def median_step(t: Any) -> Any:
    """Median of the steps of t (n,), n >= 2."""
    steps = np.empty(len(t) - 1)
    for k in range(len(steps)):
        steps[k] = t[k + 1] - t[k]
    return median(steps)
