"""Decay ratio of the autocorrelation, Miao and Seborg 1999: does the oscillation last or die out?

    R = a / b,    b = mean of two maxima of the ACF less the minimum between them
                  a = the second maximum less the mean of the minima on either side,        oscillating if R > 0.5

For an ACF exp(-s k) cos(w k) R is its decay over half a period, q = exp(-pi s / w), whichever maxima are taken. Those
after the first crossing of zero are taken, because noise stands at lag 0, and each must leave the band that noise of
the same colour keeps to (``acf_crossings``): in plain noise neighbouring swings are alike too, and R is near 1.

Source: Miao and Seborg 1999, Control Eng. Practice 7:73 (the ratio and its limit). Ours: which maxima, and the band.
"""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np
from stickslip.detect.oscillation.correlogram import correlogram
from stickslip.detect.oscillation.even import CYCLES_MIN, regularity
from stickslip.detect.oscillation.gate import GATE_CARD, Gate
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = replace(
    GATE_CARD,
    name="miao_seborg", title="Decay ratio of the ACF", source="Miao and Seborg 1999, Control Eng. Practice 7:73",
    assumes=("one dominant period",),
    finds="whether an oscillation lasts (R near 1) or is well damped (R near 0)",
    index=(0.0, 1.0), cost="O(n log n)",
    pros=("separates sustained from damped", "noise stands at lag 0 only"),
    cons=("several periods mix", "a drift hides the crossings of the ACF"),
)  # fmt: skip
LOBES = 5  # between the crossings of the ACF: two maxima and three minima, or the other way round


@dataclass(frozen=True)
class Params:
    """Least R [-], of the paper; z of the noise band [-]."""

    ratio_min: float = 0.5
    band: float = 1.96


def decay_ratio(rho: Values, zeros: Values) -> float:
    """R [-] of an ACF (n,) with its crossings of zero [lags], six at least.

    A wave that halves its ACF every half period:

    >>> k = np.arange(200)
    >>> round(decay_ratio(0.5 ** (k / 20) * np.cos(np.pi * k / 20), 10.0 + 20.0 * np.arange(6)), 2)
    0.5
    """
    lobes = [rho[math.ceil(a) : math.floor(b) + 1] for a, b in itertools.pairwise(zeros[: LOBES + 1])]
    _, high_1, low_2, high_2, low_3 = (float(np.max(np.abs(lobe))) for lobe in lobes)
    return (high_2 + 0.5 * (low_2 + low_3)) / (0.5 * (high_1 + high_2) + low_2)


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test the control error of the longest good stretch.

    >>> t = np.arange(0.0, 1000.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    found = correlogram(record, p.band, LOBES + 1)
    if isinstance(found, Gate):
        return found
    signal, amplitude, rho, zeros = found
    ratio = decay_ratio(rho, zeros)
    intervals = np.diff(zeros[: 2 * LOBES + 1]) * signal.dt
    period = 2.0 * float(np.mean(intervals))
    cycles = len(signal.x) * signal.dt / period
    oscillating = ratio > p.ratio_min and cycles >= CYCLES_MIN and period >= 4.0 * signal.dt
    reason = (
        f"{'Sustained' if oscillating else 'No sustained'} oscillation: decay ratio of the autocorrelation "
        f"{ratio:.2f} (limit {p.ratio_min:g}), period {period:.4g} s, {cycles:.1f} cycles."
    )
    return Gate(oscillating, period, regularity(intervals), amplitude, cycles, reason)
