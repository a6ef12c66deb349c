"""The last part of a long record: as short as shows enough of OP's turns, so that none of them is lost by thinning.

A week at one sample a second holds 600,000 samples; thinned to 20,000 a cycle of two minutes is left with four, and
nothing of a stick is seen.  So a long record is not thinned but cut: the last ``most`` samples, twice as many, four
times as many and so on, until OP turns ``TURNS`` times in them.
"""

import math

import numpy as np
from stickslip.detect.stem.stick import turns
from stickslip.logs.arrays import Values

LONGEST = 7_200  # points of a grid that are looked at: the longest records that the verdict was fitted on
TURN_SHARE = 0.3  # of OP's range: a smaller way back is no turn
TURNS = 40  # of OP in the part that is looked at
PERIODS = 20.0  # of an oscillation in it
PARTS, PADDED = 8, 8  # of a record whose strongest wave is sought; points of its spectrum a sample
SEEN = 1500  # blocks in which turns of a record of up to some thousand samples are counted


def recent(op: Values, most: int, period: float = math.nan) -> int:
    """Index of the first sample of OP (n,) that is used; 0 if ``most`` samples hold all of it.

    ``most`` : least number of samples that are kept; ``period`` [samples] of an oscillation, NaN where none is known.

    >>> t = np.arange(100_000.0)
    >>> [len(t) - recent(np.sin(2 * np.pi * t / P), 5000) for P in (50.0, 800.0, 60_000.0)]
    [5000, 20000, 100000]
    """
    n, length = len(op), most
    least = PERIODS * period if math.isfinite(period) else 0.0
    while length < n:
        part = op[n - length :]
        span = float(np.percentile(part, 99) - np.percentile(part, 1))
        if length >= least and span > 0.0 and length >= TURNS * samples_per_turn(part, span, most):
            return n - length
        length *= 2
    return 0


def samples_per_turn(u: Values, span: float, seen: int = SEEN) -> float:
    """Samples between two turns of OP u (n,), at least 2, from ``seen`` or a few more blocks of it.

    ``span`` : usual range of u [unit of u].  A turn goes back by 0.3 of the range that is usual in an eighth of the
    record, so that a few moves of the set point do not hide a cycle, and by more than noise and a tenth of the whole
    range, but never by more than 0.3 of that.
    """
    k = max(1, len(u) // seen)
    x = blocks(u, k)
    parts = x[: len(x) // 8 * 8].reshape(8, -1)
    usual = float(np.median(np.ptp(parts, axis=1)))
    limit = min(max(TURN_SHARE * usual, 6.0 * differenced_noise(x), 0.1 * span), TURN_SHARE * span)
    return max(k * len(x) / (len(turns(x, limit)) + 1.0), 2.0)


def samples_per_period(op: Values) -> float:
    """Samples a period of the strongest wave in OP (n,): the peak of its spectrum; NaN where OP stands.

        |sum w (op - line) exp(-2 pi i k / m)|^2      w Hann's window, the mean over eighths of the record

    Each eighth is less its straight line, so that no drift hides a fast cycle, and counts by its own power, so that no
    step of the set point does.  Nothing keeps the number from falling to 2, as ``samples_per_turn`` is kept.

    >>> t = np.arange(2000.0)
    >>> [round(samples_per_period(np.sin(2 * np.pi * t / P)), 1) for P in (2.2, 3.1, 3.9, 12.0)]
    [2.2, 3.1, 3.9, 12.0]
    """
    m = len(op) // PARTS
    time = np.linspace(-1.0, 1.0, m)
    parts = op[: PARTS * m].reshape(PARTS, m)
    x = parts - parts.mean(axis=1, keepdims=True)
    x = x - np.outer(x @ time / (time @ time), time)
    power = np.mean(x * x, axis=1)
    moves = power > 1e-12 * max(float(np.max(op * op)), 1e-300)
    if not moves.any():
        return math.nan
    lines = np.abs(np.fft.rfft(x[moves] * np.hanning(m), PADDED * m, axis=1)) ** 2
    strongest = int(np.argmax((lines / power[moves, None]).mean(axis=0)[1:])) + 1
    return PADDED * m / strongest


def blocks(x: Values, k: int) -> Values:
    """Means of k samples each of x (n,), shape (n // k,)."""
    m = len(x) // k
    return np.asarray(x[: m * k].reshape(m, k).mean(axis=1)) if k > 1 else x


def differenced_noise(y: Values) -> float:
    """Standard deviation of white noise on y (n,) by the median third difference, which is blind to a smooth wave."""
    d = np.diff(y, 3)
    return float(np.median(np.abs(d))) / (0.6745 * math.sqrt(20.0))
