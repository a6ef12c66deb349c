"""The noise on a logged stem position, which slips and slides as well, and the step of a tag that is rounded."""

import math

import numpy as np
from stickslip.detect.signals.smoothing import noise_std
from stickslip.logs.arrays import Values

QUIET, QUIET_STEP = 0.25, 0.3186  # share of the steps that a standing stem makes; that quantile of |normal| noise
# A stem that goes to and fro between two places looks rounded to its jump where these are multiples of it by chance:
# once in 500 with this limit.
MULTIPLE_SHARE = 0.001  # of the step, that values may be off its multiples


def stem_noise(t: Values, u: Values, mv: Values) -> float:
    """Standard deviation of the noise on a logged stem mv (n,) [its unit], which slips and slides as well.

    A stem that follows OP has the noise of u, too; one that slips every few samples has a jump in most stretches of
    five samples, but stands in between: there a quarter of its steps are below 0.45 sigma.  Whatever the stem does
    beside adds to each of these, so that the least counts.  A rounded tag may flicker by one step.

    >>> t = np.arange(600.0)
    >>> slips = np.where(t % 8 < 4, 1.0, -1.0) + np.random.default_rng(0).normal(0, 0.05, 600)
    >>> round(stem_noise(t, np.sin(t * np.pi / 4), slips), 2), round(noise_std(t, slips), 1)
    (0.07, 0.7)
    """
    steps = np.abs(np.diff(mv))
    standing = float(np.percentile(steps, 100.0 * QUIET)) / (math.sqrt(2.0) * QUIET_STEP)
    return max(min(noise_std(t, mv), noise_std(t, mv - u), standing), rounding(mv) / math.sqrt(12.0))


def rounding(x: Values) -> float:
    """The step of x (n,), in its unit, if it is rounded: all values are multiples of it; else 0.

    A stem that slips by the same jump each time stands at few places, too, but these are no multiples of the jump.

    >>> x = np.array([1.0, 2.5, 1.0, 2.0])
    >>> float(rounding(x)), float(rounding(x + 0.2))
    (0.5, 0.0)
    """
    apart = np.diff(np.unique(x))
    step = float(np.min(apart[apart > 1e-9 * np.ptp(x)], initial=math.inf)) if np.ptp(x) > 0.0 else 0.0
    return step if step > 0.0 and bool(np.all(np.abs(x / step - np.round(x / step)) < MULTIPLE_SHARE)) else 0.0
