"""Spectrum of OP and PV with the harmonics of the oscillation.

    A(f) = sqrt(P(f)),  P by Welch's method: Hann windows of ``PERIODS`` periods, half overlapping, linear trend off
    harmonic k = sqrt(sum of P within f_0 / 4 of k f_0 / sum of P within f_0 / 4 of f_0)

A sine has none; a symmetric triangle has 1/9 at 3 f_0, a square 1/3 (analytic).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs.arrays import Values

PERIODS = 12.0
HARMONICS_MAX = 5  # harmonics looked for
SAMPLES_MIN = 64  # samples of a spectrum


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes over frequency, each signal over its own largest line.

    f : (m,) [Hz]; op, pv : (m,) [-]
    fundamental : frequency of the oscillation [Hz], NaN where there is none
    of_op, of_pv : harmonic k -> its amplitude over that of the fundamental [-], k = 2 .. 5 below half the sampling rate
    """

    f: Values = field(repr=False)
    op: Values = field(repr=False)
    pv: Values = field(repr=False)
    fundamental: float
    of_op: Mapping[int, float]
    of_pv: Mapping[int, float]


def spectrum(loop: Prepared) -> Spectrum | None:
    """The spectrum of a prepared record; None where fewer than ``SAMPLES_MIN`` samples are left.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(3000.0)
    >>> triangle = np.abs(t / 30 % 2 - 1)
    >>> found = spectrum(Prepared(LoopRecord.from_arrays(t, pv=triangle, op=50 + triangle, sp=0 * t + 0.5)))
    >>> round(1 / found.fundamental), round(found.of_pv[3], 2), round(found.of_pv[2], 2)
    (60, 0.11, 0.0)
    """
    from scipy.signal import welch

    grid = loop.whole
    n = len(grid)
    if n < SAMPLES_MIN:
        return None
    samples = loop.period / grid.dt
    length = min(n, max(SAMPLES_MIN, round(PERIODS * samples))) if math.isfinite(samples) else max(SAMPLES_MIN, n // 4)
    powers = []
    for x in (grid.op, grid.pv):
        f, power = welch(x, 1.0 / grid.dt, "hann", length, length // 2, detrend="linear")
        powers.append(power[1:])
    f = f[1:]
    f_0 = 1.0 / loop.period if math.isfinite(loop.period) else math.nan
    op, pv = (np.sqrt(p / p.max()) if p.max() > 0.0 else np.zeros(len(p)) for p in powers)
    return Spectrum(f, op, pv, f_0, _harmonics(f, powers[0], f_0), _harmonics(f, powers[1], f_0))


def _harmonics(f: Values, power: Values, f_0: float) -> dict[int, float]:
    if not math.isfinite(f_0):
        return {}
    lines = {k: float(power[np.abs(f - k * f_0) <= 0.25 * f_0].sum()) for k in range(1, HARMONICS_MAX + 1)}
    if not lines[1] > 0.0:
        return {}
    return {k: math.sqrt(lines[k] / lines[1]) for k in range(2, HARMONICS_MAX + 1) if (k + 0.25) * f_0 <= f[-1]}
