"""Does PV follow OP, or OP follow PV?  At no lag the PV-OP picture shows the controller, not the valve.

    r(k) = corr(PV(t + k), s OP(t)),   lag = the k of the largest r within half a period

s is the sign of the process gain, which in a loop that holds is that of the controller.  A sticky valve or a lag makes
PV follow (lag > 0).  Where PV leads, or the two move at once, OP is made from PV by strong P action or by an outside
wave.
"""

import math

import numpy as np
from stickslip.detect.health.fact import Fact
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.stick import turn_time
from stickslip.logs.arrays import Values


def lag_of_pv(op: Values, pv: Values, sign: float, half: float) -> tuple[float, float]:
    """Lag of PV behind OP [samples] within ``half`` either way, and the correlation there [-].

    >>> t = np.arange(2000.0)
    >>> lag, r = lag_of_pv(np.sin(t / 20), np.sin((t - 7) / 20), 1.0, 62.8)
    >>> round(lag), round(r, 2)
    (7, 1.0)
    """
    n, reach = len(op), max(round(half), 1)
    size = 1 << (n + reach).bit_length()
    u, y = op - np.mean(op), pv - np.mean(pv)
    spread = float(np.linalg.norm(u) * np.linalg.norm(y))
    if spread == 0.0:
        return math.nan, 0.0
    both = np.fft.irfft(np.fft.rfft(y, size) * np.conj(np.fft.rfft(u, size)), size) * sign / spread
    at = np.concatenate([both[-reach:], both[: reach + 1]]) * n / (n - np.abs(np.arange(-reach, reach + 1)))
    k = int(np.argmax(at))
    fine = 0.0
    if 0 < k < len(at) - 1:
        bend = at[k - 1] - 2.0 * at[k] + at[k + 1]
        fine = 0.5 * (at[k - 1] - at[k + 1]) / bend if bend < 0.0 else 0.0
    return float(k - reach + fine), float(at[k])


def causality(op: Values, pv: Values, e: Values, period: float, limit: float = 0.5, dt: float = 1.0) -> Fact:
    """Lag of PV behind OP on an even grid [samples]; at ``limit`` or below PV does not follow. It is reported, not
    refused.

    ``period`` [samples] of the oscillation, NaN without one; ``dt`` [s] of a sample, for the words.
    """
    remedy = "Log faster than the loop moves, at the controller's scan; or log the stem position."
    if len(op) < 50 or np.ptp(op) == 0.0 or np.ptp(pv) == 0.0:
        still = "Too little moves to see what follows what."
        return Fact("not_causal", False, math.nan, limit, still, remedy, forbids=False, judged=False)
    half = min(turn_time(op, period)[1], len(op) / 4.0)
    lag, _ = lag_of_pv(op, pv, controller_sign(op, e), half)
    present = bool(lag <= limit)
    text = (
        f"PV does not follow OP: the two agree best at a lag of {lag * dt:.3g} s (above {limit * dt:.3g} s needed). "
        "The PV-OP picture shows the controller, not the valve."
        if present
        else f"PV follows OP by {lag * dt:.3g} s."
    )
    return Fact("not_causal", present, lag, limit, text, remedy, forbids=False)
