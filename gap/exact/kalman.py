"""The Kalman filter of a linear diagram from row to row: innovations of unit variance, and their variances.

    at a row      e = (y - H z) / sqrt(s),   s = H P H' + r,   z += K sqrt(s) e,   P -= K s K'     signal by signal
    to the next   z = A z + ...,   P = A P A' + Q

r is the variance of the log's rounding, step^2 / 12.  Where all rows are of one kind and have all signals the gains
settle, and are kept until a signal is missing.  Behind a row where a controller may be at its limit nobody knows what
it remembers: its variance grows there, and what it gives tells nothing at that row.
Source: Anderson and Moore, Optimal Filtering (1979), sections 3.1 and 6.4 (one signal after the other).
"""

import math

import numpy as np
from stickslip.logs.compiled import njit

SETTLED = 1e-10  # share by which the variance of a signal may still change from row to row
SMALLEST = 1e-300  # variance


@njit(cache=True, inner=True, error_model="numpy")
def add_product(A, B, out):  # type: ignore[no-untyped-def]
    """Add A B to ``out``, whole rows at once: sums of different columns do not wait for each other."""
    for i in range(len(A)):
        for k in range(len(B)):
            if A[i, k] != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += A[i, k] * B[k, j]


@njit(cache=True, inner=True, error_model="numpy")
def time_update(P, A, Q, room):  # type: ignore[no-untyped-def]
    """Replace P by A P A' + Q; ``room`` for what lies between."""
    n = len(P)
    room[:] = 0.0
    add_product(A, P, room)
    for i in range(n):
        for j in range(i):
            room[i, j], room[j, i] = room[j, i], room[i, j]
    P[:] = Q
    add_product(A, room, P)
    for i in range(n):
        for j in range(i):
            P[j, i] = P[i, j]


@njit(cache=True, inner=True, error_model="numpy")
def measurement_update(P, h, r, K):  # type: ignore[no-untyped-def]
    """Take in one signal with the row ``h`` of z: write its gain, lower P, return the variance of its innovation."""
    n = len(P)
    s = r
    K[:] = 0.0
    for j in range(n):
        if h[j] != 0.0:
            for i in range(n):
                K[i] += P[j, i] * h[j]
    for i in range(n):
        s += h[i] * K[i]
    s = max(s, SMALLEST)
    for i in range(n):
        for j in range(n):
            P[i, j] -= K[i] * K[j] / s
    for i in range(n):
        K[i] /= s
    return s


@njit(cache=True, error_model="numpy")
def filtered(kind, A, Q, H, added, unknown, Y, r, z, P, e, S, shown):  # type: ignore[no-untyped-def]
    """Write the innovations ``e``, their variances ``S``, and what the mean has ``shown``, (rows, signals).

    ``kind``, ``A``, ``Q``, ``H``, ``added`` are those of ``Rows``; ``unknown`` (rows, n) variance that is added to z
    behind a row; ``Y`` (rows, signals), NaN where a signal says nothing; ``r`` (rows, signals)
    variance of its rounding; ``z``, ``P`` at the first row, which are changed.
    """
    n, m = len(z), Y.shape[1]
    K, s, room, new, settled = np.zeros((m, n)), np.ones(m), np.empty((n, n)), np.empty(n), False
    for i in range(len(Y)):
        k = kind[i]
        missing, change = False, 0.0
        for j in range(m):
            missing |= Y[i, j] != Y[i, j]
            shown[i, j] = added[i, j]
            for p in range(n):
                shown[i, j] += H[k, j, p] * z[p]
            if i > 0 and r[i, j] != r[i - 1, j]:
                settled = False
        settled = settled and not missing
        for j in range(m):
            e[i, j] = S[i, j] = math.nan
            if Y[i, j] != Y[i, j]:
                continue
            miss = Y[i, j] - added[i, j]
            for p in range(n):
                miss -= H[k, j, p] * z[p]
            if not settled:
                now = measurement_update(P, H[k, j], r[i, j], K[j])
                change = max(change, abs(now - s[j]) / now)
                s[j] = now
            for p in range(n):
                z[p] += K[j, p] * miss
            e[i, j] = miss / math.sqrt(s[j])
            S[i, j] = s[j]
        for p in range(n):
            new[p] = added[i, m + p]
            for q in range(n):
                new[p] += A[k, p, q] * z[q]
        z[:] = new
        for p in range(n):
            if unknown[i, p] > 0.0:
                settled = False
                P[p, p] += unknown[i, p]
        if not settled:
            time_update(P, A[k], Q[k], room)
            settled = len(A) == 1 and not missing and change < SETTLED
