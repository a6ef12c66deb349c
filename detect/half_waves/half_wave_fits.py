"""Least-squares fits of known shapes to half waves, for the methods that ask which shape a wave has.

Each half wave has phases x in 0..1 between its crossings and values y, positive; each shape s(x) is zero at both ends.
With the height a = sum(y s) / sum(s^2) the mean squared error is

    E = (sum(y^2) - sum(y s)^2 / sum(s^2)) / m

    sine            s = sin(pi x)
    triangle        s = 1 - |2 x - 1|
    free triangle   s = x / x_p before the apex x_p, (1 - x) / (1 - x_p) after it; every sample is tried as x_p
    relay wave      s = 1 - exp(-x / g) for x <= q g, (2 - exp(-q)) exp(-(x - q g) / g) - 1 after it,
                    g = 1 / (q + ln(2 - exp(-q)))

The relay wave is the answer of a first-order process with dead time theta = q tau to a relay, g = tau / T; it goes from
the triangle (q = 0) to the square (q = infinity). Without dead time it is also the wave of a square MV behind a lag.

All half waves are fitted at once: one pass over their samples for each shape, two for the free triangle.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from stickslip.detect.half_waves.waves import HalfWave
from stickslip.logs.arrays import Indices, Values

RATIOS: Values = np.geomspace(0.05, 30.0, 25)  # theta / tau tried, as in the paper of Rossi and Scali


class Samples(NamedTuple):
    """The inner samples of H half waves in one row: phase and y (N,), first sample (H,), number of samples (H,)."""

    phase: Values
    y: Values
    first: Indices
    length: Values

    def sums(self, x: Values) -> Values:
        """The sum of x (N,) over each half wave, (H,)."""
        return np.asarray(np.add.reduceat(x, self.first))


class Fit(NamedTuple):
    """Mean squared error [unit^2], height [unit] and free parameter (apex, theta / tau; else NaN), each (H,)."""

    error: Values
    height: Values
    parameter: Values


def gather(halves: Sequence[HalfWave]) -> Samples:
    """The samples between the crossings of all half waves; raises ValueError without any half wave.

    >>> x = np.linspace(0.0, 1.0, 51)
    >>> one = gather([HalfWave(0, x, 3.0 * np.sin(np.pi * x), 1.0, 50.0)])
    >>> fit = sine(one)
    >>> round(float(fit.height[0]), 6), round(float(fit.error[0]), 6)
    (3.0, 0.0)
    """
    if not halves:
        raise ValueError("no half waves given; give at least one")
    count = np.array([len(half.y) - 2 for half in halves])
    first = np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.intp)
    phase = np.concatenate([half.phase[1:-1] for half in halves])
    return Samples(phase, np.concatenate([half.y[1:-1] for half in halves]), first, count.astype(float))


def _fit(x: Samples, shape: Values) -> Fit:
    product, power, energy = x.sums(x.y * shape), x.sums(shape * shape), x.sums(x.y * x.y)
    error = np.maximum(energy - product**2 / power, 0.0) / x.length
    return Fit(error, product / power, np.full(len(x.first), math.nan))


def sine(x: Samples) -> Fit:
    """The best half sine of each half wave."""
    return _fit(x, np.sin(np.pi * x.phase))


def triangle(x: Samples) -> Fit:
    """The best symmetric triangle of each half wave."""
    return _fit(x, 1.0 - np.abs(2.0 * x.phase - 1.0))


def relay_wave(phase: Values, q: float) -> Values:
    """The relay wave at phases 0..1 for 0 < q = theta / tau < 700, of height 1 for large q.

    >>> relay_wave(np.array([0.0, 0.5, 1.0]), 30.0).round(3).tolist()
    [0.0, 1.0, 0.0]
    """
    g = 1.0 / (q + math.log(2.0 - math.exp(-q)))
    decay = np.exp(phase / -g)
    return np.asarray(np.where(phase <= q * g, 1.0 - decay, (2.0 * math.exp(q) - 1.0) * decay - 1.0))


def relay(x: Samples, ratios: Values = RATIOS) -> Fit:
    """The best relay wave of each half wave among ``ratios`` of theta / tau, which are returned as parameter."""
    shapes = [relay_wave(x.phase, float(q)) for q in ratios]
    product = np.array([x.sums(x.y * shape) for shape in shapes])
    power = np.array([x.sums(shape * shape) for shape in shapes])
    best, each = np.argmax(product**2 / power, axis=0), np.arange(len(x.first))
    height = product[best, each] / power[best, each]
    error = np.maximum(x.sums(x.y * x.y) - height * product[best, each], 0.0) / x.length
    return Fit(error, height, ratios[best])


def free_triangle(x: Samples) -> Fit:
    """The best triangle of each half wave with its apex at any of the samples; the apex [-] is the parameter.

    With running sums of y x, y (1 - x), x^2 and (1 - x)^2 up to each sample, every apex costs the same few operations.
    """
    up, down = x.phase, 1.0 - x.phase

    def before_and_after(left: Values, right: Values) -> tuple[Values, Values]:
        run_left, run_right = np.cumsum(left), np.cumsum(right)
        of_sample = np.repeat(np.arange(len(x.first)), x.length.astype(int))
        start = (run_left - left)[x.first][of_sample]
        end = run_right[x.first + x.length.astype(int) - 1][of_sample]
        return run_left - start, end - run_right

    yu, yd = before_and_after(x.y * up, x.y * down)
    uu, dd = before_and_after(up * up, down * down)
    possible = (up > 0.0) & (down > 0.0)  # a sample may fall on the crossing itself
    left, right = np.where(possible, up, 1.0), np.where(possible, down, 1.0)
    product = yu / left + yd / right
    power = uu / left**2 + dd / right**2
    gain = np.where(possible, product**2 / power, -1.0)
    best = np.array(
        [a + np.argmax(gain[a : a + int(m)]) for a, m in zip(x.first, x.length, strict=True)], dtype=np.intp
    )
    error = np.maximum(x.sums(x.y * x.y) - gain[best], 0.0) / x.length
    return Fit(error, (product / power)[best], x.phase[best])


def folded(halves: Sequence[HalfWave], points: int = 41, most: int = 60) -> tuple[Values, Values]:
    """Phases (points,) and at most ``most`` of the half waves on them, (h, points), each over its best sine."""
    phase = np.linspace(0.0, 1.0, points)
    shown = halves[:: -(-len(halves) // most)]
    height = sine(gather(shown)).height
    return phase, np.array([np.interp(phase, half.phase, half.y) for half in shown]) / height[:, None]
