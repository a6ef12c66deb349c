"""Correlation of OP and PV with themselves and with each other.

    r_xy(tau) = mean of x(t) y(t + tau) over the samples that overlap / (sd x sd y),   linear trend off

``lag`` is where PV most resembles OP, of either sign, within half a period behind it.  With a sticky valve before a
self-regulating process the correlation of OP and PV is odd, near zero at no lag; an outside wave or tight tuning gives
an even one (Horch 1999, Control Eng. Practice 7:1221).
"""

import math
from dataclasses import dataclass, field

import numpy as np
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs.arrays import Values

PERIODS = 2.5  # to either side
RECORD_SHARE = 0.125  # of the record to either side, where nothing oscillates
SAMPLES_MIN = 64  # samples


@dataclass(frozen=True, eq=False)
class Correlation:
    """Correlations over lags.

    lags : (2 m + 1,) [s], from -m to m; op, pv : (m + 1,) of each signal with itself, lags from 0 on [-]
    both : (2 m + 1,) of PV behind OP [-]; positive lag: PV later
    period : [s], NaN without an oscillation
    lag : of PV behind OP, as the loop's facts have it [s]; at_lag, at_zero : the correlation there and at no lag [-]
    """

    lags: Values = field(repr=False)
    op: Values = field(repr=False)
    pv: Values = field(repr=False)
    both: Values = field(repr=False)
    period: float
    lag: float
    at_lag: float
    at_zero: float


def correlation(loop: Prepared) -> Correlation | None:
    """The correlations of a prepared record; None where too few samples are left or a signal stands still.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(2000.0)
    >>> loop = Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.sin((t + 7) / 8), sp=0 * t))
    >>> found = correlation(loop)
    >>> found.lag, round(found.at_lag, 2), round(found.at_zero, 2)
    (7.0, 1.0, 0.64)
    """
    from scipy.signal import detrend

    grid = loop.whole
    n = len(grid)
    if n < SAMPLES_MIN:
        return None
    u, y = detrend(grid.op), detrend(grid.pv)
    if min(np.std(u), np.std(y)) <= 1e-9 * max(np.max(np.abs(grid.op)), np.max(np.abs(grid.pv)), 1e-300):
        return None
    samples = loop.period / grid.dt
    m = min(n // 3, round(PERIODS * samples) if math.isfinite(samples) else round(RECORD_SHARE * n))
    uu, yy, uy = _r(u, u, m), _r(y, y, m), _r(u, y, m)
    at = max(-m, min(m, round(loop.causality.value)))
    lags = np.asarray(np.arange(-m, m + 1) * grid.dt, dtype=np.float64)
    return Correlation(lags, uu[m:], yy[m:], uy, loop.period, at * grid.dt, float(uy[m + at]), float(uy[m]))


def _r(x: Values, y: Values, m: int) -> Values:
    """r_xy at the lags -m .. m."""
    n = len(x)
    size = 1 << (n + m).bit_length()
    full = np.fft.irfft(np.conj(np.fft.rfft(x, size)) * np.fft.rfft(y, size), size)
    found = np.concatenate([full[-m:], full[: m + 1]]) if m else full[:1]
    overlap = n - np.abs(np.arange(-m, m + 1))
    return np.asarray(found / overlap / (np.std(x) * np.std(y)))
