"""Stretches of ``W``: copy one, and look whether one is finite."""

import numpy as np
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")
def copy(W, source, target, n):  # type: ignore[no-untyped-def]
    """Copy ``n`` floats inside ``W``."""
    for i in range(n):
        W[target + i] = W[source + i]


@njit(cache=True, error_model="numpy")
def finite(W, start, n):  # type: ignore[no-untyped-def]
    """Return whether ``n`` floats from ``start`` are all finite."""
    total = 0.0
    for i in range(n):
        total += W[start + i] * 0.0
    return total == 0.0 and not np.isnan(total)
