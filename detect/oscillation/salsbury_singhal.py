"""Poles of an ARMA model, Salsbury and Singhal 2005: how little damped is the mode that makes the wave?

    x(t) = a1 x(t-1) + a2 x(t-2) + e(t) + c e(t-1),    poles p of z^2 - a1 z - a2
    zeta = -ln|p| / sqrt(ln^2 |p| + arg^2 p),    period = 2 pi / arg p,    oscillating if p is complex and zeta < 0.1

a1, a2 follow from the autocorrelation, rho(k) = a1 rho(k-1) + a2 rho(k-2) for k >= 2, by least squares over
the lags of one period: e and its zero c do not enter there, and white noise on x enters at lag 0 only. The signal is
brought to some 16 samples a period before, because poles crowd at 1 when sampling is fast.

Source: Salsbury and Singhal 2005, American Control Conference. The limit of zeta is not known for certain; 0.1 is ours,
as are the estimation by autocorrelation and the band that its first swings must leave.
"""

import cmath
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from stickslip.detect.oscillation.correlogram import correlogram
from stickslip.detect.oscillation.even import CYCLES_MIN, acf, regularity
from stickslip.detect.oscillation.gate import GATE_CARD, Gate
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = replace(
    GATE_CARD,
    name="salsbury_singhal", title="Poles of an ARMA model",
    source="Salsbury and Singhal 2005, American Control Conference",
    assumes=("one dominant period", "a wave near a sine"),
    finds="damping and period of the mode behind the wave",
    index=(0.0, 1.0), cost="O(n log n)",
    pros=("a damping that engineers know", "short records"),
    cons=("one mode only", "strong harmonics bias the damping", "the limit is a matter of choice"),
)  # fmt: skip
PER_PERIOD = 16


@dataclass(frozen=True)
class Params:
    """Largest damping [-]; z of the noise band that the first swings of the ACF must leave [-]."""

    zeta_max: float = 0.1
    band: float = 1.96


class Mode(NamedTuple):
    """Damping [-] and period [samples]; zeta = 1 and an endless period where the poles are real."""

    zeta: float
    period: float


def mode(rho: Values, lags: int) -> Mode:
    """The mode behind an autocorrelation (n,), from so many lags.

    >>> k = np.arange(100)
    >>> p = 0.98 ** k * np.cos(2 * np.pi * k / 16)
    >>> found = mode(p, 32)
    >>> round(found.period, 2), round(found.zeta, 3)
    (16.0, 0.051)
    """
    past = np.stack([rho[1 : lags - 1], rho[: lags - 2]], axis=1)[1:]  # from lag 1 on: noise stands at lag 0
    a1, a2 = np.linalg.lstsq(past, rho[3:lags], rcond=None)[0]
    root = cmath.sqrt(a1 * a1 + 4.0 * a2)
    pole = 0.5 * (a1 + root)
    angle = abs(cmath.phase(pole))
    if abs(root.imag) < 1e-12 or angle == 0.0:
        return Mode(1.0, math.inf)
    decay = math.log(max(abs(pole), 1e-300))
    return Mode(-decay / math.hypot(decay, angle), 2.0 * math.pi / angle)


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test the control error of the longest good stretch.

    >>> t = np.arange(0.0, 1000.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    found = correlogram(record, p.band, 3)
    if isinstance(found, Gate):
        return found
    signal, amplitude, _, zeros = found
    intervals = np.diff(zeros[:11])
    each = max(1, round(2.0 * float(np.mean(intervals)) / PER_PERIOD))
    n = len(signal.x) // each
    coarse = acf(signal.x[: n * each].reshape(n, each).mean(axis=1))
    lags = min(2 * PER_PERIOD, len(coarse) // 3)
    if lags < 8:
        return Gate.none(f"{n} samples of a sixteenth period are too few for a model.", amplitude)
    seen = mode(coarse, lags)
    period = seen.period * each * signal.dt
    cycles = len(signal.x) * signal.dt / period
    oscillating = seen.zeta < p.zeta_max and cycles >= CYCLES_MIN and period >= 4.0 * signal.dt
    reason = (
        f"{'Oscillating' if oscillating else 'Not oscillating'}: damping {seen.zeta:.2f} (limit {p.zeta_max:g}), "
        f"period {period:.4g} s, {cycles:.1f} cycles."
    )
    return Gate(oscillating, period, regularity(intervals), amplitude, cycles, reason)
