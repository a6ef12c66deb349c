"""Zero-phase smoothing and noise level of unevenly sampled signals.

The moving average is taken over time, not over samples: the samples are joined by straight lines and the
area under them is averaged over a window centred on each sample. It therefore needs no even grid and has no
phase, and one rule serves logs of any sampling.
"""

from typing import Literal

import numpy as np
from stickslip.logs.arrays import Values


def moving_average(t: Values, x: Values, width: float, ends: Literal["shrink", "hold"] = "shrink") -> Values:
    """Centred moving average over ``width`` [s] of time, shape (n,).

        y(t) = 1/w * integral of x from t - w/2 to t + w/2

    Near the ends the window shrinks symmetrically ("shrink": keeps the shape) or the nearest full window is
    repeated ("hold": a baseline that does not follow the last swing).

    >>> t = np.arange(5.0)
    >>> moving_average(t, 2 * t, 2.0).tolist()
    [0.0, 2.0, 4.0, 6.0, 8.0]
    """
    if width <= 0 or len(t) < 3:
        return x.copy()
    from stickslip.detect.signals.smoothing_kernels import averages

    averaged = np.empty(len(t))
    averages(
        np.ascontiguousarray(t, dtype=np.float64), np.ascontiguousarray(x, dtype=np.float64), float(width),
        ends == "hold", averaged,
    )  # fmt: skip
    return averaged


def noise_std(t: Values, x: Values) -> float:
    """Standard deviation of white measurement noise [unit of x], blind to a smooth wave below.

    Each sample is predicted by the cubic through its two neighbours on either side; the error has the
    variance sigma^2 (1 + sum of squared weights). The median of the scaled errors / 0.6745 is robust
    against corners and jumps. On a clean sine of 50 samples a period it reads 0.003 % of the amplitude, and
    noise between samples that is itself smooth (coloured) escapes it.

    >>> rng = np.random.default_rng(0)
    >>> t = np.arange(2000.0)
    >>> round(noise_std(t, np.sin(t / 8) + rng.normal(0, 0.1, 2000)), 2)
    0.1
    """
    from stickslip.detect.signals.smoothing_kernels import noise

    return float(noise(np.ascontiguousarray(t, dtype=np.float64), np.ascontiguousarray(x, dtype=np.float64)))
