"""Passes over a signal, compiled: its spread, its steps and its firm changes of sign.

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
