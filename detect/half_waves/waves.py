"""The half waves of a wave, each between two crossings of zero, with its samples.

A half wave is accepted from 0.25 to 1 period long, with five samples or more inside and a peak above half of the
standard deviation.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.half_waves.half_cycles import SAMPLES_MIN
from stickslip.detect.signals.crossings import crossings
from stickslip.logs.arrays import Values


class HalfWave(NamedTuple):
    """One half wave: where it stands on the grid, its phase 0..1 (m,), and its values, made positive (m,).

    ``sign`` is that of the signal there, ``length`` [s] the time between the crossings.
    """

    start: int
    phase: Values
    y: Values
    sign: float
    length: float


def half_waves_of(t: Values, y: Values, period: float) -> list[HalfWave]:
    """Return the accepted half waves of a centred y (n,) at times t (n,) [s], in order; none if ``period`` is NaN.

    >>> t = np.arange(100.0)
    >>> [(half.start, half.sign, round(half.length, 1)) for half in half_waves_of(t, np.sin(t / 8), 50.3)]
    [(26, -1.0, 25.1), (51, 1.0, 25.1)]
    """
    if len(t) < 2 or not math.isfinite(period):
        return []
    std, found = float(np.std(y)), []
    for start, end in itertools.pairwise(crossings(t, y, 0.1 * std)):
        first, stop = np.searchsorted(t, [start, end], side="left")
        inside = y[first:stop]
        length = float(end - start)
        if len(inside) < SAMPLES_MIN or not 0.25 * period <= length <= period:
            continue
        sign = 1.0 if inside.sum() >= 0.0 else -1.0
        if np.max(sign * inside) <= 0.5 * std:
            continue
        phase = np.concatenate([[0.0], (t[first:stop] - start) / length, [1.0]])
        found.append(HalfWave(int(first), phase, np.concatenate([[0.0], sign * inside, [0.0]]), sign, length))
    return found
