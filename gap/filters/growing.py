"""Noise of a sensor that grows with what it measures, as a rival of noise that is the same everywhere.

    h = c (x^2 / mean(x^2) - 1),   c = 1 - s_0 / s
    loss of it = loss + 1/2 sum over rows and signals of  ln(1 + h) + e^2 / (1 + h) - e^2

s the variance of an innovation with the noise that was found, s_0 without what is beyond the model's; x the signal
before the noise, as the filter foretells it.  Such noise has one size as well, and takes the place of the other.
"""

import numpy as np
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.filters.checks import CALM
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import tried


def growing(now: Filtered) -> dict[str, float]:
    """Return the negative log likelihood if the additional noise of a sensor grows with the signal; None for other
    effects.
    """
    one, f = now.explanation, now.explanation.filtering
    signals = [str(s) for s in f.quiet[one.place].output_labels] if isinstance(one.effect, SensorNoise) else []
    bare = tried(Explanation(f), {key: now.values[key] for key in f.free})
    if bare is None or not set(signals) & set(f.signals) or now.values["factor"] <= 1.0:
        return {}
    j = next(f.signals.index(s) for s in signals if s in f.signals)
    rows = f.counted
    square = (f.Y[:, j] - now.e[:, j] * np.sqrt(now.S[:, j]))[rows] ** 2
    more = np.clip(1.0 - bare.S / now.S, 0.0, 1.0)[rows]
    h = more * (square / np.nanmean(square) - 1.0)[:, None]
    size = np.minimum(now.e[rows] ** 2, CALM**2)
    return {
        f"a noise that grows with {f.signals[j]}": now.nll
        + 0.5 * float(np.nansum(np.log1p(h) + size / (1.0 + h) - size))
    }
