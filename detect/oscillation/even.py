"""The signal that oscillation detectors look at: the control error of the longest good stretch, evenly sampled."""

from typing import NamedTuple

import numpy as np
from stickslip.detect.oscillation.gate import REGULARITY_MAX
from stickslip.detect.signals.gaps import bridgeable, split
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

SAMPLES_MIN = 20
CYCLES_MIN = 3.0


class Even(NamedTuple):
    """e = SP - PV (PV without SP) less its straight line: times t (n,) [s], x (n,), step dt [s]."""

    t: Values
    x: Values
    dt: float


def even(record: LoopRecord) -> Even | None:
    """The longest good stretch on an even grid; None where it has fewer than 20 samples or does not move.

    >>> t = np.arange(100.0)
    >>> bool(abs(even(LoopRecord.from_arrays(t, pv=np.sin(t) + t, op=t)).x.mean()) < 1e-9)
    True
    """
    parts = split(record, bridgeable(record, record.log.duration / CYCLES_MIN))
    if not parts:
        return None
    part = max(parts, key=len)
    t, raw = record.t[part], (record.pv if record.e is None else record.e)[part]
    if len(t) < SAMPLES_MIN:
        return None
    grid = np.linspace(t[0], t[-1], len(t))
    x = np.interp(grid, t, raw)
    centred = grid - np.mean(grid)
    x = x - np.mean(x)
    x = x - centred * (centred @ x) / (centred @ centred)
    if float(np.std(x)) <= 1e-12 * max(1e-300, float(np.max(np.abs(raw)))):
        return None
    return Even(grid, x, float(grid[1] - grid[0]))


def acf(x: Values) -> Values:
    """Autocorrelation of x (n,) at lags 0 .. n - 1, biased, 1 at lag 0.

    >>> acf(np.array([1.0, -1.0, 1.0, -1.0])).round(2).tolist()
    [1.0, -0.75, 0.5, -0.25]
    """
    n = len(x)
    r = np.fft.irfft(np.abs(np.fft.rfft(x - np.mean(x), 2 * n)) ** 2)[:n]
    return np.asarray(r / r[0])


def regularity(intervals: Values) -> float:
    """mean / (3 std) of crossing intervals (m,) [-], at most 999; 0 for fewer than three.

    >>> regularity(np.array([5.0, 5.0, 5.0]))
    999.0
    """
    if len(intervals) < 3:
        return 0.0
    spread = float(np.std(intervals, ddof=1))
    return min(REGULARITY_MAX, float(np.mean(intervals)) / (3.0 * spread)) if spread > 0.0 else REGULARITY_MAX
