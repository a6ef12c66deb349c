"""A row is taken in, and all scans until the next one are passed in one step, where nothing is near a limit."""

import math

import numpy as np
from stickslip.logs.compiled import njit

CLOSE = 4.0  # standard deviations from a limit within which it may be reached


@njit(cache=True)
def along(a, row):  # type: ignore[no-untyped-def]
    """Return a . row; most of a is 0."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] * row[i]
    return total


@njit(cache=True)
def forecast(z, at, m, ahead, out):  # type: ignore[no-untyped-def]
    """Write what limits are held against at each scan until the next row, then z there, where nothing is at a limit."""
    for i in range(len(out)):
        out[i] = at[m + i]
    for q in range(len(z)):
        for i in range(len(out)):
            out[i] += ahead[q, i] * z[q]


@njit(cache=True)
def clear(out, bounds, sd):  # type: ignore[no-untyped-def]
    """Return whether all that is forecast keeps clear of its limits."""
    for k in range(len(sd)):
        for c in range(len(bounds)):
            value = out[k * len(bounds) + c]
            far = min(value - bounds[c, 0], bounds[c, 1] - value)
            if far < CLOSE * sd[k, c] or far <= 0.0:
                return False
    return True


@njit(cache=True)
def taken_in(z, y, K, s, r, acts, bounds, jumps, at, e, S, now):  # type: ignore[no-untyped-def]
    """Take in a row with steady gains, ``now`` z behind it; False if something may be at a limit, or is missing."""
    n, m = len(z), len(y)
    for c in range(len(bounds)):
        value = at[m + c]
        for q in range(n):
            value += jumps.ahead[q, c] * z[q]
        if not bounds[c, 0] < value < bounds[c, 1]:
            return False
    now[:] = z
    for j in range(m):
        guess, c = at[j] + along(jumps.seen[j], now), acts[j]
        if not np.isfinite(y[j]):
            return False
        if c >= 0:
            near = 1.8 * math.sqrt(12.0 * r[j])
            if not bounds[c, 0] + near < y[j] < bounds[c, 1] - near or not bounds[c, 0] < guess < bounds[c, 1]:
                return False
        for q in range(n):
            now[q] += K[j, q] * (y[j] - guess)
        e[j] = (y[j] - guess) / math.sqrt(s[j])
        S[j] = s[j]
    return True
