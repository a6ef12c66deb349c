"""Mean period and half peak-to-peak of a signal, for the tests of the plant only."""

import numpy as np


def period_and_amplitude(t, y):
    """Return (mean period [s], half peak-to-peak); upward crossings counted with a hysteresis of 0.3 amplitudes."""
    y = y - 0.5 * (y.max() + y.min())
    amplitude = 0.5 * (y.max() - y.min())
    below, starts = False, []
    for time, value in zip(t, y, strict=True):
        if value < -0.3 * amplitude:
            below = True
        elif below and value > 0.3 * amplitude:
            starts.append(time)
            below = False
    return (float(np.mean(np.diff(starts))) if len(starts) > 1 else np.nan), float(amplitude)
