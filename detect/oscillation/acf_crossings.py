"""Oscillation test by the zero crossings of the autocorrelation, Thornhill, Huang and Zhang 2003.

    P = 2 mean(d),    r = mean(d) / (3 std(d)),    oscillating if r > 1

d are the intervals between the first eleven zero crossings of the autocorrelation function (ACF) rho. Noise
makes crossings too, so they count only while the ACF swings beyond the band that noise of the same colour
keeps to (Bartlett 1946, n samples, z = 1.96 for 95 %):

    |rho(k)| > z sqrt((1 - k / n) / n * (1 + 2 sum of rho(j)^2 over j before the first crossing))

White noise has the sum 0. The slower a noise, the wider its band: without the sum, up to 33 % of slow noises
pass. A sine of c cycles has a band of z / (2 sqrt(c)), whatever the sampling. A wave of fewer than four samples a
period changes its sign with nearly every sample, as noise does, and does not pass either.

Measured: share of noises taken for an oscillation [%], 1000 seeds each (500 of the loop), by samples:

    samples                                             200     1000    3000
    white noise                                         0.2     0.3     0.4
    AR(1), coefficient 0.5                              0.4     0.5     0.4
    AR(1), coefficient 0.8                              0.4     0.2     0.4
    AR(1), coefficient 0.95                             0.1     1.0     0.6
    AR(1), coefficient 0.99                             0.0     0.3     0.9
    AR(1), coefficient -0.8                             0.0     0.0     0.0
    random walk                                         0.0     0.0     0.1
    white noise through lags of 10 and 30 samples       0.0     0.3     0.6
    white noise through two lags of 5 samples           0.1     0.8     0.4
    well damped PI loop under a random walk             0.0     1.6     1.4

Waves of four cycles (sine, triangle, square, exponential, 12 to 400 samples a period, up to 30 % noise) all passed,
of three cycles none.

A period that drifts smears the ACF of a long record, or leaves only the period of its slowest part. A record that
does not pass, or whose halves pass with different periods, is therefore halved, and its halves again; when the
parts that pass make up two thirds of it, it oscillates, each part with its own period. Noise passes hardly more
often so, because several parts have to.  Halves that cannot hold 3.5 cycles of a fifth less period are not asked.

Source: J. Process Control 13 (2003) 91; Bartlett, J. Royal Stat. Soc. Suppl. 8 (1946) 27. Ours: the sum up to the
first crossing in place of the one over all lags, to which a true oscillation would contribute; the halving; and
the second try after removal of drift, because a slow drift lifts the whole ACF off zero and hides the crossings.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from stickslip.detect.oscillation.gate import GATE_CARD, REGULARITY_MAX, Gate, Stretch
from stickslip.detect.signals.gaps import bridgeable, split
from stickslip.detect.signals.smoothing import moving_average
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

Beat = tuple[float, int, float, float, float, float]  # standard deviation, and what ``acf_kernels.beat`` says [lags]
_SAMPLES_MIN = 20  # to test at all
_PART_MIN = 100  # samples of the shortest part
_SHORT = 512  # samples up to which the autocorrelation is summed up lag by lag

CARD = replace(
    GATE_CARD,
    name="acf_crossings", title="ACF zero crossings",
    source="Thornhill, Huang and Zhang 2003, J. Process Control 13:91",
    assumes=("one dominant period", "three cycles or more"),
    finds="whether the loop oscillates, its period and regularity",
    cost="O(n log n)",
    pros=("noise of any colour seldom passes", "the period may drift", "no tuning per loop"),
    cons=("two mixed periods lower the regularity", "needs four cycles, and more in slow noise"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings of the test.

    regularity_min : least regularity r [-], of the paper
    crossings, intervals_min : zero crossings used, of the paper, and fewest intervals between them
    cycles_min : fewest cycles in the record
    samples_min : fewest samples a period
    band : z of the noise band [-]; 1.96 is its 95 %
    halvings : how often a record that does not pass, or whose period drifts, is halved
    drift_max : largest difference between the periods of two halves of one period [-]
    share_min : least share of the time that the parts that pass must make up [-]
    """

    regularity_min: float = 1.0
    crossings: int = 11
    intervals_min: int = 4
    cycles_min: float = 3.5
    samples_min: float = 4.0
    band: float = 1.96
    halvings: int = 4
    drift_max: float = 0.2
    share_min: float = 2 / 3


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test e = SP - PV (PV when SP is not logged) of the longest good stretch of a record.

    Gaps far shorter than any period that the record can show are bridged; see ``gaps.bridgeable``.

    >>> t = np.arange(0.0, 500.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    parts = split(record, bridgeable(record, record.log.duration / p.cycles_min))
    if not parts:
        return Gate.none("No good samples to test for an oscillation.")
    part = max(parts, key=len)
    x = record.pv if record.e is None else record.e
    return find_in(record.t[part], x[part], p)


def find_in(t: Values, x: Values, p: Params = Params()) -> Gate:
    """Test one signal, shapes (n,): t [s] increasing, x in any unit; the samples are joined by straight lines."""
    whole = _find_one(t, x, p)
    parts = _parts(t, x, whole, p) if len(t) >= 2 * _PART_MIN else []
    if len(parts) < 2:
        return whole
    stretches = tuple(s for gate in parts for s in gate.stretches)
    covered, cycles = sum(s.end - s.start for s in stretches), sum(gate.cycles for gate in parts)
    periods, regularity = [s.period for s in stretches], min(gate.regularity for gate in parts)
    reason = (
        f"Oscillation of a drifting period, {min(periods):.4g} to {max(periods):.4g} s, in {len(parts)} parts "
        f"that make up {covered / (t[-1] - t[0]):.0%} of the time: regularity {regularity:.2g} or more in each "
        f"(limit {p.regularity_min:g}), {cycles:.1f} cycles."
    )
    return Gate(True, covered / cycles, regularity, whole.amplitude, cycles, reason, stretches)


def _parts(t: Values, x: Values, whole: Gate, p: Params) -> list[Gate]:
    """The gates of the parts that pass, each of one period, in order of time; none once too much has failed."""
    found, failed = [], 0.0
    allowed = (1 - p.share_min) * (t[-1] - t[0])
    known = {(0, len(t)): whole}  # a half is asked for by whether its whole drifts, and again by itself
    waiting = [(0, len(t), 0)]  # first sample, end, how often halved

    def gate_of(first: int, end: int) -> Gate:
        if (first, end) not in known:
            known[first, end] = _find_one(t[first:end], x[first:end], p)
        return known[first, end]

    while waiting:
        first, end, halvings = waiting.pop()
        gate = gate_of(first, end)
        middle = (first + end) // 2
        may_halve = halvings < p.halvings and end - first >= 2 * _PART_MIN
        few = gate.cycles * (1 + p.drift_max) < 2 * p.cycles_min  # for two halves, each of a period of its own
        if may_halve and (
            not gate.oscillating or (not few and _drifts((gate_of(first, middle), gate_of(middle, end)), p))
        ):
            waiting += [(middle, end, halvings + 1), (first, middle, halvings + 1)]
        elif gate.oscillating:
            found.append(gate)
        else:
            failed += t[end - 1] - t[first]
            if failed > allowed:
                return []
    return found


def _drifts(halves: tuple[Gate, Gate], p: Params) -> bool:
    """Whether both halves of a signal oscillate, with periods that differ."""
    periods = [gate.period for gate in halves if gate.oscillating and gate.period is not None]
    return len(periods) == 2 and max(periods) > (1 + p.drift_max) * min(periods)


def _find_one(t: Values, x: Values, p: Params) -> Gate:
    """Test for one period over the whole signal, as it is and with its drift removed."""
    from stickslip.detect.oscillation.acf_kernels import levelled, short_beat_without_drift

    n = len(t)
    if n < _SAMPLES_MIN:
        return Gate.none(f"{n} samples are too few to test for an oscillation.")
    grid, y = np.empty(n), np.empty(n)
    std, largest = levelled(np.ascontiguousarray(t), np.ascontiguousarray(x), grid, y)
    if std <= 1e-12 * max(1e-300, largest):
        return Gate.none("The signal does not move.")
    first = _acf_test(grid, _beat(y, p), p)
    if first.oscillating:
        return first
    width = 2 * _strongest_period(y, float(grid[1] - grid[0]))
    if n <= _SHORT:
        second = _acf_test(grid, short_beat_without_drift(grid, y, width, p.band, p.crossings), p)
    else:
        second = _acf_test(grid, _beat(y - moving_average(grid, y, width, ends="hold"), p), p)
    # A wave that drift removal brings out must carry a fair part of the variance, or it is not the story.
    if second.oscillating and 0.5 * second.amplitude**2 > 0.1 * std**2:
        return second
    return first if first.regularity >= second.regularity else second


def _acf_test(t: Values, beat: Beat, p: Params) -> Gate:
    """What the crossings of the autocorrelation of a signal at the times t (n,) say."""
    n, dt = len(t), float(t[1] - t[0])
    std, found, mean, spread, low, high = beat
    amplitude = math.sqrt(2.0) * std
    if found - 1 < p.intervals_min:
        if found > 2 and high <= 1.5 * low and n < 2.0 * mean * p.cycles_min:
            return _too_short(2.0 * dt * mean, n * dt, amplitude, p)
        reason = (
            f"No sustained oscillation: the autocorrelation of e swings through zero {found} "
            f"time{'s' * (found != 1)} beyond the band of noise, {p.intervals_min + 1} are needed."
        )
        return Gate.none(reason, amplitude)
    regularity = min(REGULARITY_MAX, mean / (3.0 * spread)) if spread > 0.0 else REGULARITY_MAX
    period = 2.0 * dt * mean
    cycles = n * dt / period
    if period < p.samples_min * dt:
        reason = (
            f"No oscillation that differs from noise: e changes its sign every {mean:.1f} samples "
            f"(one each {dt:.3g} s). If it does oscillate, a faster log will show it."
        )
        return Gate.none(reason, amplitude)
    if cycles < p.cycles_min:
        return _too_short(period, n * dt, amplitude, p)
    oscillating = regularity > p.regularity_min
    word = "Regular" if oscillating else "No regular"
    reason = (
        f"{word} oscillation: period {period:.4g} s, regularity {regularity:.2g} "
        f"(limit {p.regularity_min:g}), {cycles:.1f} cycles."
    )
    where = (Stretch(float(t[0]), float(t[-1]), period),) if oscillating else ()
    return Gate(oscillating, period, regularity, amplitude, cycles, reason, where)


def _beat(y: Values, p: Params) -> Beat:
    """Standard deviation of y (n,), crossings of its autocorrelation, and what ``acf_kernels.beat`` says of them."""
    from stickslip.detect.oscillation.acf_kernels import beat, centred, short_beat

    n = len(y)
    if n <= _SHORT:
        found: Beat = short_beat(y, p.band, p.crossings)
        return found
    padded = np.zeros(_quick_length(2 * n))
    std = centred(y, padded)
    spectrum = np.fft.rfft(padded)
    power = spectrum.real**2 + spectrum.imag**2
    return std, *beat(np.fft.irfft(power)[:n], p.band, p.crossings)


@lru_cache(maxsize=64)
def _quick_length(n: int) -> int:
    """The smallest even product of 2, 3 and 5 that is at least n: spectra of such lengths are quick."""
    twos = [2 << k for k in range(n.bit_length())]
    odds = [int(3**i * 5**j) for i in range(8) for j in range(6)]
    return min(length for two in twos for odd in odds if (length := two * odd) >= n)


def _too_short(period: float, duration: float, amplitude: float, p: Params) -> Gate:
    cycles = duration / period
    reason = f"Only {cycles:.1f} cycles of {period:.4g} s in the record, {p.cycles_min:g} are needed."
    return Gate(False, period, 0.0, amplitude, cycles, reason)


def significant_crossings(acf: Values, band: float, most: int | None = None) -> Values:
    """Zero crossings [lags] up to the last swing that leaves the noise band of the module's docstring.

    Those after the first ``most`` are not looked at.
    """
    from stickslip.detect.oscillation.acf_kernels import swings

    found = np.empty(len(acf) if most is None else most)
    count = swings(np.ascontiguousarray(acf), band, len(found), found)
    return found[:count].copy()


def _strongest_period(y: Values, dt: float) -> float:
    """Period of the highest spectral line with at least three cycles in the record [s]."""
    spectrum = np.fft.rfft(y * _hanning(len(y)))[3:]
    power = spectrum.real**2 + spectrum.imag**2
    return len(y) * dt / (3 + int(power.argmax()))


@lru_cache(maxsize=8)
def _hanning(n: int) -> Values:
    window = np.hanning(n)
    window.flags.writeable = False
    return window
