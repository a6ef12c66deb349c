"""The autocorrelation of the control error and its zeros, from which ``miao_seborg`` and ``salsbury_singhal`` begin."""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.oscillation.acf_crossings import significant_crossings
from stickslip.detect.oscillation.even import Even, acf, even
from stickslip.detect.oscillation.gate import Gate
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values


class Correlogram(NamedTuple):
    """The even error, its amplitude [unit of PV], its ACF ``rho`` (n,) [-], and where that crosses zero (m,) [lags]."""

    signal: Even
    amplitude: float
    rho: Values
    zeros: Values


def correlogram(record: LoopRecord, band: float, least: int) -> Correlogram | Gate:
    """Return the correlogram of the longest good stretch; the answer of a gate if e rests or rho crosses too seldom.

    A crossing counts if the ACF leaves the ``band`` of noise on either side; ``least`` of them are needed.

    >>> t = np.arange(0.0, 1000.0)
    >>> found = correlogram(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t), 2.0, 3)
    >>> np.diff(found.zeros[:4]).round().tolist()
    [25.0, 25.0, 25.0]
    """
    signal = even(record)
    if signal is None:
        return Gate.none("No stretch of 20 good samples in which e moves.")
    amplitude = math.sqrt(2.0) * float(np.std(signal.x))
    rho = acf(signal.x)
    zeros = significant_crossings(rho, band)
    if len(zeros) < least:
        swings = f"the autocorrelation swings through zero {len(zeros)} times beyond the band of noise"
        return Gate.none(f"No oscillation: {swings}, {least} are needed.", amplitude)
    return Correlogram(signal, amplitude, rho, zeros)
