"""The filter: how a state and its spread go from stop to stop, and what each row of a log says of them.

    between stops     z = f(z),  D = [d_j],  d_j = (f(z + w L_j) - f(z - w L_j)) / 2w       P = L L' = D D'
    noise             a column sd sqrt(1 - phi^2) for each source that draws anew at the stop
    at a row          e = (y - h(z)) / sqrt(s),   s = H H' + r,   K = D H' / s,   z = z + K sqrt(s) e,
                      D = D - K H sqrt(s) / (sqrt(s) + sqrt(r))                     one signal after the other

f is the run of the diagram itself, so the mean follows every nonlinearity and every limit, and the spread is that of
differences across it (w = sqrt 3, the third moment of a normal state).  H are the differences of a logged signal.
Source: the extended filter of Anderson and Moore, Optimal Filtering (1979), section 8.2, in the square root form of
Potter (Maybeck, Stochastic Models, Estimation and Control 1 (1979), section 7.3).
"""

import math

import numpy as np
from numba import njit

from engine.members import arrive, pass_instant, put, read, restore

WIDE = math.sqrt(3.0)
DROPPED = 1e-13  # share of its size below which what is left of a state's variance is rounding


@njit(cache=True, error_model="numpy")
def compressed(D, columns, size, L):  # type: ignore[no-untyped-def]
    """Write a factor of D D' with as few columns as it takes to ``L``; return how many (Cholesky with pivots)."""
    n = len(size)
    P = np.empty((n, n))
    for i in range(n):
        for k in range(i + 1):
            s = 0.0
            for j in range(columns):
                s += D[i, j] * D[k, j]
            P[i, k] = P[k, i] = s / (size[i] * size[k])
    rest = np.empty(n)
    for i in range(n):
        rest[i] = P[i, i]
    found = 0
    while found < n:
        p, top = 0, -1.0
        for i in range(n):
            if rest[i] > top and rest[i] > DROPPED * P[i, i]:
                p, top = i, rest[i]
        if top <= 0.0:
            break
        root = math.sqrt(top)
        for i in range(n):
            s = P[i, p]
            for j in range(found):
                s -= L[i, j] * L[p, j] / (size[i] * size[p])
            L[i, found] = s / root * size[i]
        for i in range(n):
            rest[i] -= (L[i, found] / size[i]) ** 2
        rest[p] = -1.0
        found += 1
    return found


@njit(cache=True, error_model="numpy")
def through(I, W, buffer, no_rows, places, shown, noisy, phi, t, z, y):  # type: ignore[no-untyped-def]
    """Advance one member to a stop and through it; write its state and what it shows there; return a status."""
    status = arrive(I, W, buffer, no_rows, t)
    if status != 0:
        return status
    for q in range(len(noisy)):
        W[noisy[q]] *= phi[q]
    status = pass_instant(I, W, buffer, no_rows)
    if status != 0:
        return status
    read(W, places, z)
    read(W, shown, y)
    return 0


@njit(cache=True, nogil=True, error_model="numpy")
def filtered(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, shown, noisy, at, size, times, row_of, phi, spread, Y, r, held, order,
    z, L, columns, gains, given, e, S,
):  # fmt: skip
    """Write innovations ``e`` of unit variance and their variances ``S``, (rows, signals); return a status.

    ``kept`` integers and ``saved`` floats make a run; ``places`` (n,) of the state, ``shown`` (m,) of logged signals,
    ``noisy`` (q,) of the noises in force, which stand ``at`` (q,) in the state; ``size`` (n,) of states.
    ``times`` (k,) of the stops [s], ``row_of`` the row of the log there, -1 for none; ``phi``, ``spread`` (k, q) how
    much of a noise stays at a stop, and the standard deviation of what is drawn.  ``Y`` (rows, m), ``r`` (m,) variance
    of rounding; ``held`` whether a value that says nothing new is skipped; ``order`` (m,) in which signals are taken.
    ``z`` (n,), ``L`` (n, n) of which ``columns`` count: the state before the first stop.  ``gains`` (rows, n + m, m) of state and signals are
    written, or used where ``given``: then only the mean is followed, and ``S`` is what it was.
    """
    n, m, q = len(places), len(shown), len(noisy)
    no_rows = np.empty((1, 0))
    base_I, base_W = I[:kept].copy(), W[:saved].copy()
    next_I, next_W = I[:kept].copy(), W[:saved].copy()
    stop_I, stop_W = I[:kept].copy(), W[:saved].copy()
    D, H = np.empty((n, n + q)), np.empty((m, n + q))
    up, down, at_stop, mean = np.empty(n), np.empty(n), np.empty(n), z.copy()
    y, y_up, y_down = np.empty(m), np.empty(m), np.empty(m)
    member = np.empty(n)
    for k in range(len(times)):
        # the mean, kept at the stop and behind it
        restore(I, W, base_I, base_W)
        put(I, W, places, mean)
        status = arrive(I, W, buffer, no_rows, times[k])
        if status != 0:
            return status
        for j in range(q):
            W[noisy[j]] *= phi[k, j]
        stop_I[:], stop_W[:] = I[:kept], W[:saved]
        read(W, places, at_stop)
        status = pass_instant(I, W, buffer, no_rows)
        if status != 0:
            return status
        next_I[:], next_W[:] = I[:kept], W[:saved]
        row = row_of[k]
        read(W, shown, y)
        if given:
            read(W, places, mean)
        else:
            for j in range(columns):
                for way in range(2):
                    for i in range(n):
                        member[i] = mean[i] + (WIDE if way == 0 else -WIDE) * L[i, j]
                    restore(I, W, base_I, base_W)
                    put(I, W, places, member)
                    status = through(
                        I, W, buffer, no_rows, places, shown, noisy, phi[k], times[k],
                        up if way == 0 else down, y_up if way == 0 else y_down,
                    )  # fmt: skip
                    if status != 0:
                        return status
                for i in range(n):
                    D[i, j] = (up[i] - down[i]) / (2.0 * WIDE)
                for i in range(m):
                    H[i, j] = (y_up[i] - y_down[i]) / (2.0 * WIDE)
            width = columns
            for j in range(q):
                if spread[k, j] > 0.0:
                    for way in range(2):
                        restore(I, W, stop_I, stop_W)
                        W[noisy[j]] = at_stop[at[j]] + (WIDE if way == 0 else -WIDE) * spread[k, j]
                        status = pass_instant(I, W, buffer, no_rows)
                        if status != 0:
                            return status
                        read(W, places, up if way == 0 else down)
                        read(W, shown, y_up if way == 0 else y_down)
                    for i in range(n):
                        D[i, width] = (up[i] - down[i]) / (2.0 * WIDE)
                    for i in range(m):
                        H[i, width] = (y_up[i] - y_down[i]) / (2.0 * WIDE)
                    width += 1
            restore(I, W, next_I, next_W)
            read(W, places, mean)
        if row >= 0:
            if given:
                for i in order:
                    if Y[row, i] == Y[row, i] and S[row, i] > 0.0:
                        e[row, i] = (Y[row, i] - y[i]) / math.sqrt(S[row, i])
                        off = Y[row, i] - y[i]
                        for p in range(n):
                            mean[p] += gains[row, p, i] * off
                        for p in range(m):
                            y[p] += gains[row, n + p, i] * off
            else:
                for i in order:
                    if not Y[row, i] == Y[row, i]:
                        continue
                    s = 0.0
                    for j in range(width):
                        s += H[i, j] * H[i, j]
                    if held[i] and row > 0 and Y[row, i] == Y[row - 1, i] and s < 0.1 * r[i]:
                        continue
                    s += r[i]
                    if not s > 0.0:
                        continue
                    off = Y[row, i] - y[i]
                    e[row, i], S[row, i] = off / math.sqrt(s), s
                    less = 1.0 / (1.0 + math.sqrt(r[i] / s))
                    for p in range(n):
                        g = 0.0
                        for j in range(width):
                            g += D[p, j] * H[i, j]
                        g /= s
                        mean[p] += g * off
                        gains[row, p, i] = g
                        for j in range(width):
                            D[p, j] -= less * g * H[i, j]
                    own = H[i].copy()
                    for p in range(m):
                        g = 0.0
                        for j in range(width):
                            g += H[p, j] * own[j]
                        g /= s
                        y[p] += g * off
                        gains[row, n + p, i] = g
                        for j in range(width):
                            H[p, j] -= less * g * own[j]
        if not given:
            columns = compressed(D, width, size, L)
        base_I[:], base_W[:] = next_I, next_W
    return 0
