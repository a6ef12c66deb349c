"""The loops over samples of ``acf_crossings``, compiled: the even grid, the swings beyond the noise.

Loaded when first called.  A record under set-point moves is tested piece by piece, some fifty times a few hundred
samples, for which whole arrays are too dear.
"""

from typing import Any

import numpy as np
from stickslip.detect.signals.smoothing_kernels import averages
from stickslip.logs.compiled import njit

SUMS = {"reassoc", "contract"}  # sums may be added up in any order


@njit(cache=True, error_model="numpy", fastmath=SUMS)  # type: ignore[untyped-decorator]
def levelled(t: Any, x: Any, grid: Any, y: Any) -> tuple[float, float]:
    """x (n,) at even times, into ``grid`` (n,), less its straight line, into ``y`` (n,).

    Returns the standard deviation of y and the largest |x|.
    """
    n = len(t)
    step = (t[n - 1] - t[0]) / (n - 1)
    k, total, largest = 0, 0.0, 0.0
    for i in range(n):
        grid[i] = t[0] + i * step
    grid[n - 1] = t[n - 1]
    for i in range(n):
        while k < n - 2 and t[k + 1] <= grid[i]:
            k += 1
        y[i] = x[k] + (x[k + 1] - x[k]) / (t[k + 1] - t[k]) * (grid[i] - t[k])
    for i in range(n):
        total += y[i]
        largest = max(largest, abs(x[i]))
    mean, middle, moment, norm = total / n, 0.5 * (n - 1), 0.0, 0.0
    for i in range(n):
        moment += (i - middle) * (y[i] - mean)
        norm += (i - middle) * (i - middle)
    slope, squares = moment / norm, 0.0
    for i in range(n):
        y[i] -= mean + slope * (i - middle)
        squares += y[i] * y[i]
    return (squares / n) ** 0.5, largest


@njit(cache=True, error_model="numpy", fastmath=SUMS)  # type: ignore[untyped-decorator]
def centred(x: Any, out: Any) -> Any:
    """x (n,) less its mean into the first n of ``out``; returns the standard deviation."""
    n, total, squares = len(x), 0.0, 0.0
    for i in range(n):
        total += x[i]
    mean = total / n
    for i in range(n):
        out[i] = x[i] - mean
        squares += out[i] * out[i]
    return (squares / n) ** 0.5


@njit(cache=True, error_model="numpy", fastmath=SUMS)  # type: ignore[untyped-decorator]
def correlated(y: Any, out: Any) -> None:
    """Sums of y(i) y(i + k) over i, for each lag k into out (n,): quicker than by spectra where n is a few hundred."""
    n = len(y)
    for k in range(n):
        total = 0.0
        for i in range(n - k):
            total += y[i] * y[i + k]
        out[k] = total


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def swings(acf: Any, band: float, most: int, out: Any) -> int:
    """Zero crossings [lags] up to the last swing beyond the noise band, into ``out`` (most,); returns how many.

    ``acf`` (n,) starts at lag 0 with any scale; ``band`` is z of ``acf_crossings``.
    """
    n, scale = len(acf), acf[0]
    count, squares, variance = 0, 0.0, 0.0
    where, peak, at = 0.0, -1.0, 0
    for k in range(n):
        value = acf[k] / scale
        if count > 0 and abs(value) > peak:
            peak, at = abs(value), k
        turns = k < n - 1 and (acf[k] > 0.0) != (acf[k + 1] > 0.0)
        if count == 0 and k > 0:
            squares += value * value
        if not turns and k < n - 1:
            continue
        if count > 0:  # the swing since the crossing before ends here
            if peak < band * (variance * (1.0 - at / n)) ** 0.5 or peak < 0.0:
                return count - 1
            out[count - 1] = where
            if count == most or k == n - 1:
                return count
        elif k == n - 1:
            return 0
        else:
            variance = (1.0 + 2.0 * squares) / n
        where, peak, at = k + acf[k] / (acf[k] - acf[k + 1]), -1.0, k
        count += 1
    return 0


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def beat(acf: Any, band: float, most: int) -> tuple[int, Any, Any, Any, Any]:
    """How many crossings ``swings`` finds; mean, standard deviation, shortest and longest of their intervals [lags].

    Of fewer than two intervals the standard deviation is 0, of none all are.
    """
    found = np.empty(most)
    count = swings(acf, band, most, found)
    if count < 2:
        return count, 0.0, 0.0, 0.0, 0.0
    mean, squares = (found[count - 1] - found[0]) / (count - 1), 0.0
    low, high = found[1] - found[0], found[1] - found[0]
    for k in range(count - 1):
        interval = found[k + 1] - found[k]
        squares += (interval - mean) ** 2
        low, high = min(low, interval), max(high, interval)
    return count, mean, (squares / max(count - 2, 1)) ** 0.5, low, high


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def short_beat(y: Any, band: float, most: int) -> tuple[Any, int, Any, Any, Any, Any]:
    """Standard deviation of y (n,), and ``beat`` of its autocorrelation: quicker than by spectra where n is small."""
    n = len(y)
    centre, acf = np.empty(n), np.empty(n)
    std = centred(y, centre)
    correlated(centre, acf)
    count, mean, spread, low, high = beat(acf, band, most)
    return std, count, mean, spread, low, high


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def short_beat_without_drift(t: Any, y: Any, width: float, band: float, most: int) -> Any:
    """``short_beat`` of y (n,) less its moving average over ``width`` [s] with held ends."""
    swing = np.empty(len(y))
    averages(t, y, width, True, swing)
    for i in range(len(y)):
        swing[i] = y[i] - swing[i]
    found: tuple[Any, int, Any, Any, Any, Any] = short_beat(swing, band, most)
    return found
