"""Passes over a signal, compiled: sums, stands, samples on a line, an even grid, firm changes of sign.

Loaded when first called.  Each goes through the samples once or twice and keeps nothing, where arrays would be written
and read several times.
"""

import math
from typing import Any

from stickslip.logs.compiled import njit

SUMS = {"reassoc", "contract"}  # sums may be added up in any order


@njit(cache=True, error_model="numpy", fastmath=SUMS)  # type: ignore[untyped-decorator]
def spread(x: Any) -> tuple[float, float]:
    """Mean and standard deviation of x (n,), n >= 1; exactly 0 where x stands still."""
    n, total, squares = len(x), 0.0, 0.0
    for i in range(n):
        total += x[i] - x[0]
    mean = total / n
    for i in range(n):
        squares += (x[i] - x[0] - mean) * (x[i] - x[0] - mean)
    return x[0] + mean, (squares / n) ** 0.5


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def steps(t: Any) -> tuple[float, float]:
    """The shortest and the longest step between neighbouring t (n,), n >= 2."""
    low, high = t[1] - t[0], t[1] - t[0]
    for i in range(2, len(t)):
        low, high = min(low, t[i] - t[i - 1]), max(high, t[i] - t[i - 1])
    return low, high


@njit(cache=True, error_model="numpy", fastmath=SUMS)  # type: ignore[untyped-decorator]
def pair(x: Any, y: Any) -> tuple[float, float, float]:
    """Standard deviations of x and y (n,), n >= 1, and their covariance."""
    n, sum_x, sum_y = len(x), 0.0, 0.0
    for i in range(n):
        sum_x += x[i] - x[0]
        sum_y += y[i] - y[0]
    mean_x, mean_y, xx, yy, xy = sum_x / n, sum_y / n, 0.0, 0.0, 0.0
    for i in range(n):
        dx, dy = x[i] - x[0] - mean_x, y[i] - y[0] - mean_y
        xx += dx * dx
        yy += dy * dy
        xy += dx * dy
    return (xx / n) ** 0.5, (yy / n) ** 0.5, xy / n


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def longest_stand(x: Any) -> tuple[int, int]:
    """First sample and length of the longest run of equal values in x (n,), n >= 1; the first of several."""
    start, best, length = 0, 0, 0
    for i in range(1, len(x) + 1):
        if i == len(x) or x[i] != x[i - 1]:
            if i - start > length:
                best, length = start, i - start
            start = i
    return best, length


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def long_stands(x: Any, least: int, out: Any) -> int:
    """First sample and end of each run of at least ``least`` equal values in x (n,), into out (m, 2); how many."""
    start, count = 0, 0
    for i in range(1, len(x) + 1):
        if i == len(x) or x[i] != x[i - 1]:
            if i - start >= least:
                out[count, 0], out[count, 1] = start, i
                count += 1
            start = i
    return count


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def repeated(x: Any, y: Any) -> tuple[int, int, int, int]:
    """How many samples repeat the one before in x and y (n,) both, in x, in y, and how many runs of both there are."""
    both, alone_x, alone_y, runs, before = 0, 0, 0, 0, False
    for i in range(1, len(x)):
        stands_x, stands_y = x[i] == x[i - 1], y[i] == y[i - 1]
        now = stands_x and stands_y
        alone_x += stands_x
        alone_y += stands_y
        both += now
        runs += now and not before
        before = now
    return both, alone_x, alone_y, runs


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def on_grid(x: Any, step: float, near: float, share: float) -> bool:
    """Whether at least a ``share`` of x (n,) lies within ``near`` steps of a grid of ``step`` through its first."""
    off, most = 0, (1.0 - share) * len(x) + 1e-9 * len(x)
    for i in range(len(x)):
        place = (x[i] - x[0]) / step
        if not abs(place - round(place)) < near:
            off += 1
            if off > most:
                return False
    return True


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def bends(t: Any, x: Any, out: Any) -> None:
    """How far each sample of x (n,), n >= 3, lies off the line between its neighbours, into out (n - 2,)."""
    for i in range(1, len(x) - 1):
        out[i - 1] = x[i] - x[i - 1] - (x[i + 1] - x[i - 1]) * ((t[i] - t[i - 1]) / (t[i + 1] - t[i - 1]))


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def curving(bend: Any, out: Any) -> None:
    """True into out (n,) where the bend (n,) has the sign of its two neighbours, and half to twice their size."""
    n = len(bend)
    for i in range(n):
        here = bend[i]
        before, after = bend[i - 1] if i > 0 else here, bend[i + 1] if i < n - 1 else here
        out[i] = here != 0.0 and 0.5 <= before / here <= 2.0 and 0.5 <= after / here <= 2.0


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def last_before(at: Any, t: Any, near: float, out: Any) -> None:
    """The last sample at ``at`` (m,) that is not later than t (n,) by more than ``near`` [s], into out (n,)."""
    k = 0
    for i in range(len(t)):
        while k < len(at) - 1 and at[k + 1] <= t[i] + near:
            k += 1
        out[i] = k


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def flips(t: Any, x: Any, band: Any, out: Any) -> int:
    """Write the times of the firm changes of sign of x (n,) into out (n,); returns how many."""
    count, last = 0, -1
    for j in range(len(x)):
        if not abs(x[j]) > band[j]:
            continue
        if last >= 0 and (x[last] > 0.0) != (x[j] > 0.0):
            first, final = math.nan, math.nan
            for k in range(last, j):
                if (x[k] > 0.0) != (x[k + 1] > 0.0):
                    final = t[k] + (t[k + 1] - t[k]) * x[k] / (x[k] - x[k + 1])
                    if math.isnan(first):
                        first = final
            out[count] = 0.5 * (first + final)
            count += 1
        last = j
    return count
