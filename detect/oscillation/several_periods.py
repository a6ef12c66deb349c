"""Several oscillations at once: spectral peaks that noise of the record's colour does not make, each tested by itself.

    g = I(f) / background(f),    background = sqrt(median of I over f/2 .. f  *  median of I over f .. 2f) / ln 2
    a peak counts if  g > ln(m / alpha)   for m frequencies: noise passes with the chance alpha

I is the periodogram under a Hann window. The background follows any colour that is smooth over two octaves, a power of
f nearly exactly, so that a slow noise is no oscillation. Around every peak the signal is band-passed (0.7 to 1.4 times
its frequency) and must be regular by the zero crossings of its autocorrelation, r = mean / (3 std) > 1 over 10
intervals, as Thornhill, Huang and Zhang 2003 do for mixed periods. Multiples of a stronger and slower oscillation are
its harmonics and are not listed.

Measured: none of 1,200 noises of the ten colours in the tests (200 and 1,000 samples) passed.

Source: J. Process Control 13 (2003) 91; Fisher 1929, Proc. R. Soc. London A 125:54 (the largest line of noise). Ours:
the background, and the rule for harmonics.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from stickslip.detect.oscillation.even import Even, acf, even, regularity
from stickslip.detect.oscillation.gate import GATE_CARD, Gate, Stretch
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

CARD = replace(
    GATE_CARD,
    name="several_periods", title="Several periods at once",
    source="Thornhill, Huang and Zhang 2003, J. Process Control 13:91",
    assumes=("periods that last through the record",),
    finds="every oscillation of a loop, its period, amplitude and regularity",
    cost="O(n log n)",
    pros=("mixed periods", "noise of any smooth colour seldom passes"),
    cons=("needs six cycles of each", "a drifting period smears its line"),
)  # fmt: skip

LEVELS = 80
UNSURE = 1.8  # 1.8 standard deviations of the logarithm of a median of few lines, which a Hann window correlates


@dataclass(frozen=True)
class Params:
    """Settings.

    alpha : chance that noise passes the test of peaks [-]
    regularity_min : least r [-], of the paper
    cycles_min, samples_min : fewest cycles in the record, fewest samples a period
    most : largest number of oscillations to find
    """

    alpha: float = 0.001
    regularity_min: float = 1.0
    cycles_min: float = 6.0
    samples_min: float = 4.0
    most: int = 5


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """The strongest of the oscillations; see ``find_all``."""
    found = find_all(record, p)
    if found:
        return max(found, key=lambda gate: gate.amplitude)
    return Gate(
        False, None, 0.0, 0.0, 0.0, "No line of the spectrum stands above noise of the same colour and is regular."
    )


def find_all(record: LoopRecord, p: Params = Params()) -> tuple[Gate, ...]:
    """Every oscillation of the control error, the slowest first.

    >>> t = np.arange(0.0, 3000.0)
    >>> two = np.sin(2 * np.pi * t / 37) + np.sin(2 * np.pi * t / 180) + np.random.default_rng(0).normal(size=3000)
    >>> [round(gate.period) for gate in find_all(LoopRecord.from_arrays(t, pv=two, op=t))]
    [180, 37]
    """
    signal = even(record)
    if signal is None:
        return ()
    n = len(signal.x)
    power = np.abs(np.fft.rfft(signal.x * np.hanning(n))) ** 2
    low, high = math.ceil(p.cycles_min), int(n / p.samples_min)
    if high <= low + 8:
        return ()
    above = _above_background(power, low, high)
    open_to = np.zeros(len(power), dtype=bool)
    open_to[low:high] = True
    limit = math.log((high - low) / p.alpha)
    found: list[Gate] = []
    for _ in range(4 * p.most):
        score = np.where(open_to & (above > limit), power, 0.0)
        top = int(np.argmax(score))
        if score[top] == 0.0 or len(found) == p.most:
            break
        gate = _test(signal, top / n, p)
        open_to[int(0.7 * top) : math.ceil(1.4 * top) + 1] = False
        if gate is not None and not _harmonic(gate, found):
            found.append(gate)
    kept = [gate for gate in found if not _harmonic(gate, found)]
    return tuple(sorted(kept, key=lambda gate: -(gate.period or 0.0)))


def _above_background(power: Values, low: int, high: int) -> Values:
    """Each line over the level that noise of the same colour has there, shape (m,); 0 outside low .. high.

    The level is worked out at ``LEVELS`` frequencies and joined by powers of f.
    """
    at, level = np.unique(np.geomspace(low, high - 1, LEVELS).astype(int)), []
    for k in at.tolist():
        below = power[max(min(k // 2, k - 7), 1) : k - 2]
        beyond = power[k + 3 : max(2 * k, k + 9) + 1]
        unsure = math.exp(UNSURE * math.sqrt(1.0 / len(below) + 1.0 / len(beyond)))
        level.append(unsure * math.sqrt(float(np.median(below)) * float(np.median(beyond))) / math.log(2.0))
    lines = np.arange(low, high)
    above = np.zeros(len(power))
    joined = np.interp(np.log(lines), np.log(at), np.log(np.maximum(level, 1e-300)))
    above[low:high] = power[low:high] / np.exp(joined)
    return above


def _test(signal: Even, f: float, p: Params) -> Gate | None:
    """The oscillation about a frequency f [1 / sample], if it is regular."""
    n = len(signal.x)
    lines = np.fft.rfft(signal.x)
    at = np.fft.rfftfreq(n)
    lines[(at < 0.7 * f) | (at > 1.4 * f)] = 0.0
    wave = np.fft.irfft(lines, n)
    rho = acf(wave)
    k = np.flatnonzero((rho[:-1] > 0) != (rho[1:] > 0))[:11]
    zeros = k + rho[k] / (rho[k] - rho[k + 1])
    intervals = np.diff(zeros) * signal.dt
    r = regularity(intervals)
    if r <= p.regularity_min:
        return None
    period = 2.0 * float(np.mean(intervals))
    amplitude, cycles = math.sqrt(2.0) * float(np.std(wave)), n * signal.dt / period
    share = float(np.var(wave) / np.var(signal.x))
    reason = (
        f"Regular oscillation: period {period:.4g} s, regularity {r:.2g} (limit {p.regularity_min:g}), {cycles:.1f} "
        f"cycles, {share:.0%} of the variance."
    )
    where = (Stretch(float(signal.t[0]), float(signal.t[-1]), period),)
    return Gate(True, period, r, amplitude, cycles, reason, where)


def _harmonic(gate: Gate, others: list[Gate]) -> bool:
    """Whether a slower oscillation has this one as a multiple, to 3 %, about as strong as in a square wave.

    There each has 1 / k, and the band takes in two or three.
    """
    for other in others:
        if other is gate or other.period is None or gate.period is None or other.amplitude <= gate.amplitude:
            continue
        times = other.period / gate.period
        near = abs(times - round(times)) < 0.03 * times
        if times > 1.5 and near and gate.amplitude < 2.5 * other.amplitude / times:
            return True
    return False
