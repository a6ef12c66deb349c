"""Filter a log with a scanned diagram: innovations of unit variance, and the likelihood of the log.

    at a row     e = (y - H z) / sqrt(s),   s = H P H' + r,   z += K sqrt(s) e        one signal after the other
    to the next  z = F z + ...,   P = F P F' + Q                                      scan by scan

    nll = 1/2 sum over rows and signals of (e^2 + ln s)                               up to a constant

r is the variance of the log's rounding, step^2 / 12.  The mean goes through the limits of the controller and the law of
the valve as they are; the covariance through their slopes, or steady where there are none (``steady``).

What the valve makes of the opening x that it is told (``law`` and its numbers a, b):
    0  nothing of its own     1  stops at a and b     2  (a^x - 1)/(a - 1)     3  moves by a per scan at most
"""

import numpy as np
from numba import njit

NONE, STOPS, CURVED, SLOW = 0, 1, 2, 3
SMALLEST = 1e-16  # variance


@njit(cache=True)
def through(law, a, b, told, held):  # type: ignore[no-untyped-def]
    """Return (mean opening over the scan, slope, opening at its end); ``held``: the opening at its beginning."""
    if law == STOPS:
        value = min(max(told, a), b)
        return value, (1.0 if value == told else 0.0), value
    if law == CURVED:
        if abs(a - 1.0) < 1e-6:
            return told, 1.0, told
        power = a**told
        return (power - 1.0) / (a - 1.0), power * np.log(a) / (a - 1.0), told
    if law == SLOW:
        way = told - held
        if abs(way) <= a:
            part = abs(way) / a  # of the scan, until it arrives
            return told - 0.5 * way * part, 1.0 - 0.5 * part, told
        end = held + np.copysign(a, way)
        return held + np.copysign(0.5 * a, way), 0.0, end
    return told, 1.0, told


@njit(cache=True)
def closed(F, v, told, n, free, slope, has_law, out):  # type: ignore[no-untyped-def]
    """Write what z becomes of z with controller and valve in the loop, (n, n)."""
    for i in range(n):
        for j in range(n):
            value = F[i, j]
            if free:
                value += F[i, n] * v[j]
            if has_law:
                seen = told[j]
                if free:
                    seen += told[n] * v[j]
                value += F[i, n + 1] * slope * seen
            out[i, j] = value


@njit(cache=True)
def spread(P, A, Q, room):  # type: ignore[no-untyped-def]
    """Replace P by A P A' + Q; A P is put into ``room``."""
    n = len(P)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                if A[i, k] != 0.0:
                    total += A[i, k] * P[k, j]
            room[i, j] = total
    for i in range(n):
        for j in range(i, n):
            total = Q[i, j]
            for k in range(n):
                total += room[i, k] * A[j, k]
            P[i, j] = total
            P[j, i] = total


@njit(cache=True)
def looked(P, h, r, K):  # type: ignore[no-untyped-def]
    """Take in one signal with the row ``h`` of z: write its gain, lower P, return the variance of its innovation."""
    n = len(P)
    s = r
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += P[i, j] * h[j]
        K[i] = total
        s += h[i] * total
    s = max(s, SMALLEST)
    for i in range(n):
        for j in range(n):
            P[i, j] -= K[i] * K[j] / s
    for i in range(n):
        K[i] /= s
    return s


@njit(cache=True)
def steady(A, Q, H, r, every, P, K, s):  # type: ignore[no-untyped-def]
    """Write the gains (signals, n) and variances (signals,) to which the filter settles; P is room and start."""
    n, m = len(Q), len(H)
    room, B, D = np.empty((n, n)), np.eye(n), np.zeros((n, n))
    for _ in range(every):
        spread(D, A, Q, room)
        B = A @ B
    for turn in range(400):
        spread(P, B, D, room)
        change = 0.0
        for j in range(m):
            new = looked(P, H[j], r[j], K[j])
            change = max(change, abs(new - s[j]) / new)
            s[j] = new
        if change < 1e-10 and turn > 3:
            break


@njit(cache=True)
def along(a, row):  # type: ignore[no-untyped-def]
    """Return a . row; most of a is 0."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] * row[i]
    return total


@njit(cache=True)
def filtered(  # type: ignore[no-untyped-def]
    F, held_F, v, told, H, Q, lo, hi, memory, beyond, start, U, Y, r, skip, op_row, every, period, offset, law, a, b,
    exact, K, s, e, S, op_path,
):  # fmt: skip
    """Write the innovations ``e`` (rows, signals) and their variances ``S``; NaN where a signal is not taken in.

    ``U`` (scans, inputs); ``Y`` (rows, signals); ``skip`` signals of a row to leave out; ``op_row``: which signal is
    the controller's output, -1 for none; ``period``, ``offset``: scans of the controller; ``exact``: the covariance is
    carried along, else gains ``K`` and variances ``s`` are steady.
    """
    n, N = len(start), F.shape[1]
    z, new, row = start.copy(), np.empty(n), np.zeros(N)
    P, room, A, k_now = np.diag(np.full(n, 1e-4)) * 1.0, np.empty((n, n)), np.empty((n, n)), np.empty(n)
    held = z[n - 1]
    m = len(H)
    memories = len(memory)
    for k in range(len(U)):
        scans = (k - offset) % period == 0
        row[n + 2 :] = U[k]
        if k % every == 0:
            i = k // every
            for j in range(m):
                e[i, j] = np.nan
                S[i, j] = np.nan
                row[:n] = z
                guess = z[n - 1]
                if j == op_row:
                    if scans:
                        guess = along(v, row)
                    inside = lo < guess < hi
                    at_limit = Y[i, j] >= hi - 1.8 * np.sqrt(12.0 * r[j]) or Y[i, j] <= lo + 1.8 * np.sqrt(12.0 * r[j])
                    beyond_it = Y[i, j] > hi + 4.0 * np.sqrt(r[j]) or Y[i, j] < lo - 4.0 * np.sqrt(r[j])
                    guess = min(max(guess, lo), hi)
                    miss = Y[i, j] - guess
                    if at_limit and not beyond_it and (not inside or abs(miss) < 12.0 * np.sqrt(s[j])):
                        continue
                else:
                    row[n] = row[n + 1] = 0.0
                    if H[j, n] != 0.0 or H[j, n + 1] != 0.0:
                        row[n] = min(max(along(v, row), lo), hi) if scans else z[n - 1]
                        row[n + 1] = through(law, a, b, along(told, row), held)[2] if law else 0.0
                    guess = along(H[j], row)
                    miss = Y[i, j] - guess
                if skip[i, j] or not np.isfinite(miss):
                    continue
                if exact:
                    h = np.zeros(n)
                    if j == op_row and not scans:
                        h[n - 1] = 1.0
                    else:
                        h[:] = H[j, :n]
                    variance = looked(P, h, r[j], k_now)
                    z += k_now * miss
                else:
                    variance = s[j]
                    z += K[j] * miss
                e[i, j] = miss / np.sqrt(variance)
                S[i, j] = variance
        row[:n] = z
        row[n] = 0.0
        row[n + 1] = 0.0
        free, slope, side, push = True, 1.0, 0, 0
        value = z[n - 1]
        if scans:
            value = along(v, row)
            row[n] = min(max(value, lo), hi)
            if row[n] != value:
                free = False
                side = 0 if value > row[n] else 1
        else:
            row[n] = value
        op_path[k] = row[n]
        if law:
            row[n + 1], slope, held = through(law, a, b, along(told, row), held)
        table = F if scans else held_F
        for i in range(n):
            new[i] = along(table[i], row)
        if scans and not free and memories:
            gained = new[memory[0]] - z[memory[0]]
            push = 0 if (gained > 0.0) == (side == 0) else 1
            for j in range(memories):
                new[memory[j]] = along(beyond[side, push, j], row)
        if exact:
            if scans:
                closed(F, v, told, n, free, slope, law > 0, A)
                if not free:
                    for j in range(memories):
                        A[memory[j]] = beyond[side, push, j, :n]
            else:
                closed(held_F, v, told, n, False, slope, law > 0, A)
                for i in range(n):
                    A[i, n - 1] += held_F[i, n] + (held_F[i, n + 1] * slope * told[n] if law else 0.0)
            spread(P, A, Q, room)
        z[:] = new
