"""The control error of all pieces of a record made ready and cut into half cycles, compiled: ``half_cycles.in_pieces``.

Loaded when first called.  A record under set-point moves has some fifty pieces of a few hundred samples, and a piece
takes ten sums, so that calling each from Python takes longer than the sums.
"""

from typing import Any

import numpy as np
from stickslip.detect.half_waves.half_cycle_kernels import half_cycles, level
from stickslip.detect.signals.kernels import flips, spread, steps
from stickslip.detect.signals.order_kernels import count_before, count_until, median_step
from stickslip.detect.signals.smoothing_kernels import averages, noise
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _less_average(t: Any, x: Any, width: float) -> tuple[Any, Any]:
    """x (n,) less its moving average with held ends, and the standard deviation of that average."""
    swing = np.empty(len(t))
    averages(t, x, width, True, swing)
    moved = spread(swing)[1]
    for k in range(len(t)):
        swing[k] = x[k] - swing[k]
    return swing, moved


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _ready(
    t: Any, x: Any, period: float, smooth_max: float, noise_share: float, drift_share: float
) -> tuple[Any, Any, bool]:
    """e (n,) of x (n,), n >= 3, at times t, the noise left in it, whether a drift came off; see ``cycles.Params``."""
    n = len(t)
    mean, std = spread(x)
    e, drifts = x - mean, False
    if t[n - 1] - t[0] > 4.0 * period:
        swing, moved = _less_average(t, x, 2.0 * period)
        sd = spread(swing)[1]
        if moved > drift_share * sd:
            e, std, drifts = swing, sd, True
    sigma = noise(t, e)
    if sigma < 1e-3 * std:
        sigma = 0.0
    low, high = steps(t)
    dt = low if low == high else median_step(t)
    width = 0.0
    if sigma > noise_share * std:
        width = min(dt * (sigma / (noise_share * std)) ** 2, smooth_max * period)
    if width > 2.0 * dt:
        smooth = np.empty(n)
        averages(t, e, width, False, smooth)
        e = smooth
        sigma *= (dt / width) ** 0.5
    # The mean over whole cycles, because the mean of a cut cycle shifts the crossings.
    if not drifts:
        cuts = np.empty(n)
        found = flips(t, e, np.full(n, 0.1 * std), cuts)
        if found >= 3:
            last = cuts[found - 1] if found % 2 else cuts[found - 2]
            first, end = count_before(t, cuts[0]), count_until(t, last)
            if end - first > 2:
                e = e - level(t[first:end], e[first:end])
    return e, sigma, drifts


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _cut(
    t: Any, e: Any, noise: float, period: float, least: int, flat_share: float, two_peaks: float, kink: float
) -> tuple[Any, Any]:
    """The crossings (m + 1,) of a prepared e (n,), and what ``half_cycles`` says between them (m, 8)."""
    std = spread(e)[1]
    times = np.empty(len(t))
    found = flips(t, e, np.full(len(t), max(0.1 * std, min(3.0 * noise, 0.5 * std))), times)
    cuts = times[:found].copy()
    rows = np.empty((max(found - 1, 0), 8))
    half_cycles(t, e, cuts, noise, period, 0.5 * std, least, flat_share, two_peaks, kink, rows)
    return cuts, rows


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def all_pieces(
    t: Any, x: Any, bounds: Any, periods: Any, smooth_max: float, noise_share: float, drift_share: float, least: int,
    flat_share: float, two_peaks: float, kink: float,
) -> tuple[Any, bool, Any]:  # fmt: skip
    """e (n,), whether a drift came off, and what ``half_cycles`` says, with start and end (m, 10), of all pieces."""
    e, rows, count, drifting = np.empty(len(t)), np.empty((len(t), 10)), 0, False
    for i in range(len(periods)):
        a, b = bounds[i], bounds[i + 1]
        made, noise, drifts = _ready(t[a:b], x[a:b], periods[i], smooth_max, noise_share, drift_share)
        drifting |= drifts
        e[a:b] = made
        cuts, found = _cut(t[a:b], made, noise, periods[i], least, flat_share, two_peaks, kink)
        for k in range(len(found)):
            rows[count, :8] = found[k]
            rows[count, 8], rows[count, 9] = cuts[k], cuts[k + 1]
            count += 1
    return e, drifting, rows[:count].copy()
