"""Period and amplitude of an oscillation, and the band of a number over many runs."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

HYSTERESIS = 0.3  # of the amplitude: ripple smaller than this is not counted as a cycle of its own


@dataclass(frozen=True)
class Oscillation:
    """Mean ``period`` [s], NaN below two upward crossings, and ``amplitude``, half of peak to peak [unit of y]."""

    period: float
    amplitude: float


def oscillation(t: ArrayLike, y: ArrayLike, hysteresis: float = HYSTERESIS) -> Oscillation:
    """Measure an oscillation: y counts as high above +h A about mid-range, as low below -h A.

    A is half of peak to peak, h the ``hysteresis`` in 0..1; the period is the mean time between turns from low to
    high.  Shapes (n,), t [s].  Raises ``ValueError`` for unequal lengths, an empty record or h outside 0..1.

    >>> t = np.arange(0.0, 500.0, 0.1)
    >>> found = oscillation(t, 2.0 + 0.3 * np.sin(2.0 * np.pi * t / 40.0))
    >>> round(found.period, 2), round(found.amplitude, 3)
    (40.0, 0.3)
    """
    times, values = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    if times.shape != values.shape or times.ndim != 1 or times.size == 0:
        raise ValueError(f"t has shape {times.shape}, y {values.shape}; give two arrays of equal length, not empty")
    if not 0.0 <= hysteresis < 1.0:
        raise ValueError(f"hysteresis = {hysteresis!r}, but it is a share of the amplitude, 0 <= h < 1")
    period, amplitude = oscillations(times, values[None], hysteresis)
    return Oscillation(float(period[0]), float(amplitude[0]))


def oscillations(t: Floats, Y: Floats, hysteresis: float = HYSTERESIS) -> tuple[Floats, Floats]:
    """Return periods [s] and amplitudes of many signals at once, each as ``oscillation`` measures it.

    Shapes: ``t`` (n,), ``Y`` (signals, n); both results (signals,).

    >>> t = np.arange(0.0, 100.0, 0.5)
    >>> period, amplitude = oscillations(t, np.array([np.sin(t), 3.0 * np.sin(0.5 * t)]))
    >>> period.round(1).tolist(), amplitude.round(2).tolist()
    ([6.3, 12.6], [1.0, 3.0])
    """
    top, bottom = Y.max(axis=1), Y.min(axis=1)
    amplitude = 0.5 * (top - bottom)
    Y_0 = Y - (0.5 * (top + bottom))[:, None]
    edge = (hysteresis * amplitude)[:, None]
    high, decided = Y_0 > 0.0, np.abs(Y_0) > edge
    period = np.full(len(Y), math.nan)
    for i in range(len(Y)):
        at = np.flatnonzero(decided[i])
        side = high[i, at]
        upward = at[1:][side[1:] & ~side[:-1]]
        if len(upward) > 1:
            period[i] = np.diff(t[upward]).mean()
    return period, np.asarray(amplitude)


def without_trend(t: ArrayLike, y: ArrayLike, width: float) -> Floats:
    """Return y less its centred moving average of ``width`` [s]; the window shrinks towards the ends.

    >>> without_trend([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0], 2.0).tolist()
    [0.0, 0.0, 0.0, 0.0]
    """
    times, values = np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    half = np.minimum(np.round(0.5 * width / (times[1] - times[0])).astype(int), np.arange(len(values)))
    half = np.minimum(half, half[::-1])
    total = np.concatenate([[0.0], np.cumsum(values)])
    i = np.arange(len(values))
    return np.asarray(values - (total[i + half + 1] - total[i - half]) / (2 * half + 1))


@dataclass(frozen=True)
class Band:
    """Median and the 5 and 95 % points of a number over ``count`` runs; NaN if it was never defined."""

    median: float
    low: float
    high: float
    count: int


def band(values: Iterable[float]) -> Band:
    """Return the band of the finite values.

    >>> band([1.0, 2.0, 3.0, float("nan")]).median
    2.0
    """
    found = np.array([v for v in values if math.isfinite(v)], dtype=float)
    if not len(found):
        return Band(math.nan, math.nan, math.nan, 0)
    low, median, high = np.percentile(found, [5.0, 50.0, 95.0]).tolist()
    return Band(median, low, high, len(found))
