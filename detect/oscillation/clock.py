"""Does a wave keep time?  One that comes from outside may, as a clock does; a cycle of the loop's own making does not.

    c_i      time at which cycle i begins, i = 0 .. n - 1
    ratio    var(c_i - a - P i) / var(c_(i+1) - c_i),    a and P by least squares

Noise shifts each beginning by itself where something outside keeps the time: then the ratio is 1/2, whatever the
noise.  A limit cycle has no time to keep: what delays one slip delays all that follow, its phase is a random walk, and
the ratio grows with the number of cycles as n / 15.  Of random walks 5 % lie below 0.55 with 16 cycles, 0.84 with 30
and 1.6 with 60; of clocks 5 % lie above 0.74, 0.67 and 0.61 (normal steps, 2,000 draws each).

It says nothing of a wave that repeats exactly, as far as its samples tell: a noise-free limit cycle does so, too.  Nor
of any other record without noise (``free_of_noise``): what shifts its beginnings is no chance, and neither law holds.
It speaks one way only: an oscillation that another loop's valve makes loses its phase too, and so does one of a process
that is moved by noise.  A sticky valve that a periodic disturbance drives keeps the time of the disturbance.

Measured on 520 simulated loops of the setting "training", seed 777001, with 16 cycles or more: below 0.55 lay none of
104 that cycle by stiction, 9 of 25 sticky ones that something else moves, and 52 of 103 others.  The rule and its limit
are ours; the two laws are those of a random walk and of independent errors.
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.signals.crossings import crossings
from stickslip.logs.arrays import Values

RATIO_MAX = 0.55  # of the ratio, below which a wave keeps time
CYCLES_MIN = 16  # fewest that show it
EXACT_STEPS = 0.02  # sampling intervals that cycles differ by at least, or they repeat as far as the samples tell
BAND_SIGMAS = 0.3  # standard deviations that the wave must leave zero by, either way


class Clock(NamedTuple):
    """The ratio of the module [-], NaN where the wave is short or repeats exactly, and the cycles counted."""

    ratio: float
    cycles: int

    @property
    def keeps_time(self) -> bool:
        """Whether something outside makes the time."""
        return self.cycles >= CYCLES_MIN and self.ratio < RATIO_MAX


def clock_of(t: Values, wave: Values) -> Clock:
    """How a wave (n,) of mean zero at times t (n,) [s] keeps time.

    >>> t, r = np.arange(6000.0), np.random.default_rng(1)
    >>> outside = np.sin(2 * np.pi * t / 60) + 0.1 * r.normal(size=6000)
    >>> own = np.sin(2 * np.pi * np.cumsum(1 + 0.3 * r.normal(size=6000)) / 60)
    >>> clock_of(t, outside).keeps_time, clock_of(t, own).keeps_time
    (True, False)
    """
    starts = crossings(t, wave, BAND_SIGMAS * float(np.std(wave)))[::2]
    n = len(starts)
    if n < 4:
        return Clock(math.nan, n)
    i = np.arange(n) - 0.5 * (n - 1.0)
    off = starts - starts.mean()
    off = off - i * (i @ off) / (i @ i)
    between = float(np.var(np.diff(starts), ddof=1))
    if between <= (EXACT_STEPS * float(t[-1] - t[0]) / (len(t) - 1.0)) ** 2:
        return Clock(math.nan, n)
    return Clock(float(off @ off) / (n - 2.0) / between, n)
