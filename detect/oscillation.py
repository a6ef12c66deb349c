"""Oscillation test by the zero crossings of the autocorrelation, Thornhill, Huang and Zhang 2003.

    P = 2 mean(d),    r = mean(d) / (3 std(d)),    oscillating if r > 1

d are the intervals between the first eleven zero crossings of the autocorrelation function (ACF). White
noise lives at lag 0 only, so the crossings of the ACF are clean where those of the signal are chopped up.
Crossings count only while the ACF swings beyond 1.96 / sqrt(n - lag), its 95 % band for white noise.

Source: J. Process Control 13 (2003) 91. The significance band and the second try after removal of drift are
ours: a slow drift lifts the whole ACF off zero and hides the crossings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from detect.card import Card
from detect.gate import REGULARITY_MAX, Gate
from detect.smoothing import moving_average
from records import LoopRecord

__all__ = ["CARD", "Params", "find", "find_in"]

Values = npt.NDArray[np.float64]

CARD = Card(
    name="oscillation",
    title="ACF zero crossings",
    source="Thornhill, Huang and Zhang 2003, J. Process Control 13:91",
    signals=("SP", "PV"),
    assumes=("one dominant period", "three cycles or more"),
    finds="whether the loop oscillates, its period and regularity",
    index=(0.0, REGULARITY_MAX),
    process=("self_regulating", "integrating"),
    streams="no",
    pros=("noise-proof", "no tuning per loop"),
    cons=("two mixed periods lower the regularity", "needs the whole window"),
    cost="O(n log n)",
    kind="gate",
)


@dataclass(frozen=True)
class Params:
    """regularity_min [-] of the paper, crossings used, fewest intervals, fewest cycles in the record."""

    regularity_min: float = 1.0
    crossings: int = 11
    intervals_min: int = 4
    cycles_min: float = 3.0


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test e = SP - PV (PV when SP is not logged) of the longest good stretch of a record.

    >>> t = np.arange(0.0, 500.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    parts = record.segments(min_samples=2)
    if not parts:
        return Gate(False, None, 0.0, 0.0, 0.0, "No good samples to test for an oscillation.")
    part = max(parts, key=len)
    return find_in(part.t, part.pv if part.e is None else part.e, p)


def find_in(t: Values, x: Values, p: Params = Params()) -> Gate:
    """Test one signal, shapes (n,): t [s] increasing without gaps, x in any unit."""
    n = len(t)
    if n < 20:
        return Gate(False, None, 0.0, 0.0, 0.0, f"{n} samples are too few to test for an oscillation.")
    grid = np.linspace(t[0], t[-1], n)
    dt = float(grid[1] - grid[0])
    y = np.interp(grid, t, x)
    line = np.polynomial.Polynomial.fit(grid, y, 1)
    y = y - line(grid)
    std = float(np.std(y))
    amplitude = float(np.sqrt(2) * std)
    if std <= 1e-12 * max(1e-300, float(np.max(np.abs(x)))):
        return Gate(False, None, 0.0, 0.0, 0.0, "The signal does not move.")
    first = _acf_test(y, dt, amplitude, p)
    if first.oscillating:
        return first
    period = _strongest_period(y, dt)
    swing = y - moving_average(grid, y, 2 * period, ends="hold")
    second = _acf_test(swing, dt, float(np.sqrt(2) * np.std(swing)), p)
    # A wave that drift removal brings out must carry a fair part of the variance, or it is not the story.
    if second.oscillating and np.var(swing) > 0.1 * std**2:
        return second
    return first if first.regularity >= second.regularity else second


def _acf_test(y: Values, dt: float, amplitude: float, p: Params) -> Gate:
    n = len(y)
    y = y - np.mean(y)
    spectrum = np.fft.rfft(y, 2 * n)
    acf = np.fft.irfft(np.abs(spectrum) ** 2)[:n]
    acf /= acf[0]
    crossings = _significant_crossings(acf)[: p.crossings]
    intervals = np.diff(crossings) * dt
    if len(intervals) < p.intervals_min:
        reason = (
            f"No sustained oscillation: the autocorrelation of e swings through zero {len(crossings)} "
            f"time{'s' * (len(crossings) != 1)} beyond its noise band, {p.intervals_min + 1} are needed."
        )
        return Gate(False, None, 0.0, amplitude, 0.0, reason)
    mean, spread = float(np.mean(intervals)), float(np.std(intervals, ddof=1))
    regularity = min(REGULARITY_MAX, mean / (3 * spread)) if spread > 0 else REGULARITY_MAX
    period = 2 * mean
    cycles = n * dt / period
    if cycles < p.cycles_min:
        reason = f"Only {cycles:.1f} cycles of {period:.4g} s in the record, {p.cycles_min:g} are needed."
        return Gate(False, period, regularity, amplitude, cycles, reason)
    oscillating = regularity > p.regularity_min
    word = "Regular" if oscillating else "No regular"
    reason = (
        f"{word} oscillation: period {period:.4g} s, regularity {regularity:.2g} "
        f"(limit {p.regularity_min:g}), {cycles:.1f} cycles."
    )
    return Gate(oscillating, period, regularity, amplitude, cycles, reason)


def _significant_crossings(acf: Values) -> Values:
    """Zero crossings [lags] up to the last swing that leaves the white-noise band."""
    n = len(acf)
    k = np.flatnonzero((acf[:-1] > 0) != (acf[1:] > 0))
    where = k + acf[k] / (acf[k] - acf[k + 1])
    bounds = np.concatenate([k, [n - 1]])
    kept = 0
    for i in range(len(k)):
        lobe = np.abs(acf[bounds[i] + 1 : bounds[i + 1] + 1])
        peak = int(np.argmax(lobe)) if len(lobe) else 0
        lag = bounds[i] + 1 + peak
        if len(lobe) == 0 or lobe[peak] < 1.96 / np.sqrt(max(n - lag, 1)):
            break
        kept = i + 1
    result: Values = where[:kept]
    return result


def _strongest_period(y: Values, dt: float) -> float:
    """Period of the highest spectral line with at least three cycles in the record [s]."""
    power = np.abs(np.fft.rfft(y * np.hanning(len(y)))) ** 2
    power[:3] = 0.0
    return len(y) * dt / max(int(np.argmax(power)), 3)
