"""Period and amplitude of an oscillation, and the band of a number over many runs."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

HYSTERESIS_SHARE = 0.3  # of the amplitude: ripple smaller than this is not counted as a cycle of its own


@dataclass(frozen=True)
class Oscillation:
    """Mean ``period`` [s], NaN below two upward crossings, and ``amplitude``, half of peak to peak [unit of y]."""

    period: float
    amplitude: float


def oscillation(t: ArrayLike, y: ArrayLike, hysteresis: float = HYSTERESIS_SHARE) -> Oscillation:
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


def oscillations(t: Floats, Y: Floats, hysteresis: float = HYSTERESIS_SHARE) -> tuple[Floats, Floats]:
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


@dataclass(frozen=True)
class Following:
    """How one swing goes with another: ``gain`` times as far [unit of y per unit of x], ``lag`` [s] later.

    The lag lies between 0 and a period.  ``share`` of the first one's variance that its sine of that period has, 0 to
    1: with a low one it does not swing at that period.
    """

    gain: float
    lag: float
    share: float


def following(t: ArrayLike, x: ArrayLike, y: ArrayLike, period: float) -> Following:
    """Return how y follows x at a ``period`` [s], by the sines of that period that lie closest to each.

    Shapes (n,), t [s].  A signal that stands has gain 0; behind one that stands, gain and lag are NaN.

    >>> t = np.arange(0.0, 300.0, 0.5)
    >>> found = following(t, np.sin(2.0 * np.pi * t / 60.0), 0.5 * np.sin(2.0 * np.pi * (t - 8.0) / 60.0), 60.0)
    >>> round(found.gain, 3), round(found.lag, 3), round(found.share, 3)
    (0.5, 8.0, 1.0)
    """
    times = np.asarray(t, dtype=float)
    both = np.column_stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)])
    waves = np.exp(2j * math.pi * times / period)
    basis = np.column_stack([waves.real, waves.imag, np.ones(len(times)), times - times.mean()])
    fitted = np.linalg.lstsq(basis, both, rcond=None)[0]
    first, second = (complex(*wave) for wave in fitted[:2].T)
    if not abs(first) > 0.0:
        return Following(math.nan, math.nan, 0.0)
    varies = float(np.var(both[:, 0]))
    turned = math.atan2((second / first).imag, (second / first).real)
    return Following(abs(second / first), turned % (2.0 * math.pi) * period / (2.0 * math.pi),
                     min(1.0, 0.5 * abs(first) ** 2 / varies) if varies else 0.0)  # fmt: skip


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
