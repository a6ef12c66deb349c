"""A filter of constant gain, row by row.

e_k = y_k - C x_k,   x_(k+1) = F (x_k + K e_k) + d_k          where y_k is NaN nothing is set right
"""

import numpy as np
from numba import njit


@njit(cache=True)
def filtered(F, C, K, drive, shown, x):  # type: ignore[no-untyped-def]
    """Return what each row shows beyond its prediction, (rows, outputs); ``x`` (n,) is left where it ends.

    ``F`` (n, n), ``C`` (outputs, n), ``K`` (n, outputs), ``drive`` (rows - 1, n), ``shown`` (rows, outputs).
    """
    rows, m = shown.shape
    n = len(x)
    e = np.empty((rows, m))
    new = np.empty(n)
    for k in range(rows):
        for i in range(m):
            s = 0.0
            for j in range(n):
                s += C[i, j] * x[j]
            e[k, i] = shown[k, i] - s
        for i in range(n):
            for j in range(m):
                if e[k, j] == e[k, j]:
                    x[i] += K[i, j] * e[k, j]
        if k == rows - 1:
            break
        for i in range(n):
            s = drive[k, i]
            for j in range(n):
                s += F[i, j] * x[j]
            new[i] = s
        for i in range(n):
            x[i] = new[i]
    return e
