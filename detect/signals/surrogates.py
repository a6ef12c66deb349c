"""Linear twins of a record: same spectrum, phases drawn anew; and the cut that lets a record repeat without a jump.

    X(f) -> |X(f)| exp(i phi),    phi uniform on 0 .. 2 pi,    X(-f) = X*(f)

What differs between a record and its twins is not linear, provided that end and start of the record fit together:
otherwise the jump between them spreads every line of the spectrum, and the twins of a clean sine swell and fade.

Source: Theiler et al. 1992, Physica D 58:77; end matching as in Thornhill 2005, IEEE Trans. Control Syst. Technol.
13:434.
"""

import numpy as np
from stickslip.logs.arrays import Values


def end_matched(x: Values, period: float, room: float = 1.5) -> slice:
    """The part of x (n,) whose last value and slope lead on to its first; even length, whole cycles.

    Start and end are looked for within ``room`` periods [samples] of the ends, for the least
    |x_a - x_b| / std(x) + |dx_a - dx_b| / std(dx).

    >>> x = np.sin(2 * np.pi * np.arange(1000) / 64)
    >>> part = end_matched(x, 64.0)
    >>> (part.stop - part.start) / 64
    15.0
    """
    reach = min(round(room * period), len(x) // 3)
    slope = np.gradient(x)
    starts = np.arange(reach)
    ends = np.arange(len(x) - reach, len(x))  # the sample that would follow the part
    spread, steep = max(float(np.std(x)), 1e-300), max(float(np.std(slope)), 1e-300)
    cost = np.abs(x[starts, None] - x[None, ends]) / spread + np.abs(slope[starts, None] - slope[None, ends]) / steep
    length = ends[None, :] - starts[:, None]
    cost = cost + 0.02 * (1.0 - length / len(x))  # of two that fit, the longer
    cost[length % 2 == 1] = np.inf
    a, b = np.unravel_index(int(np.argmin(cost)), cost.shape)
    return slice(int(starts[a]), int(ends[b]))


def phase_randomised(x: Values, count: int, rng: np.random.Generator) -> Values:
    """So many twins of x (n,), n even, shape (count, n), each with the amplitude spectrum of x.

    >>> x = np.cumsum(np.random.default_rng(0).normal(size=200))
    >>> twins = phase_randomised(x, 3, np.random.default_rng(1))
    >>> bool(np.allclose(np.abs(np.fft.rfft(twins)), np.abs(np.fft.rfft(x))))
    True
    """
    if len(x) % 2:
        raise ValueError(f"n = {len(x)}; give an even number of samples, such as ``end_matched`` cuts")
    spectrum = np.fft.rfft(x)
    turned = np.abs(spectrum) * np.exp(2j * np.pi * rng.uniform(size=(count, len(spectrum))))
    turned[:, 0], turned[:, -1] = spectrum[0], spectrum[-1]
    return np.asarray(np.fft.irfft(turned, len(x)))
