"""The half periods of the control error in time, which ``forsman_stattin`` and ``thornhill1997`` begin with."""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.oscillation.even import even
from stickslip.detect.oscillation.gate import Gate
from stickslip.detect.signals.crossings import crossings
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values


class Lobes(NamedTuple):
    """Half periods: lengths (m,) [s], areas of |e| (m,) [unit s]; sampling interval [s], sd and amplitude of e."""

    lengths: Values
    areas: Values
    dt: float
    std: float
    amplitude: float


def lobes(record: LoopRecord, band: float, least: int) -> Lobes | Gate:
    """The half periods of the longest good stretch between crossings with a ``band`` [standard deviations].

    The answer of a gate where e does not move, or has fewer than ``least`` half periods.

    >>> t = np.arange(0.0, 500.0)
    >>> found = lobes(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t), 0.1, 6)
    >>> round(float(np.median(found.lengths))), round(float(np.median(found.areas)))  # analytic: 50 / pi = 16
    (25, 16)
    """
    signal = even(record)
    if signal is None:
        return Gate.none("No stretch of 20 good samples in which e moves.")
    std = float(np.std(signal.x))
    zeros = np.asarray(crossings(signal.t, signal.x, band * std))
    area = np.concatenate([[0.0], np.cumsum(np.abs(signal.x)) * signal.dt])
    ends = np.append(signal.t, signal.t[-1] + signal.dt)
    areas = np.diff(np.interp(zeros, ends, area)) if len(zeros) else np.empty(0)
    amplitude, lengths = math.sqrt(2.0) * std, np.diff(zeros)
    if len(lengths) < least:
        return Gate.none(f"{len(lengths)} whole half periods of e; {least} are needed.", amplitude)
    return Lobes(lengths, areas, signal.dt, std, amplitude)
