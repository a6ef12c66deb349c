"""Whole cycles of an oscillation, each on the same number of points, for the methods that name the shape of a cycle."""

import itertools
import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.prepare.prepared import Prepared, Signal
from stickslip.logs.arrays import Values


class WholeCycles(NamedTuple):
    """Start and end of each cycle [s] (c,), its values (c, points), and the noise on each value [unit]."""

    start: Values
    end: Values
    y: Values
    noise: float


def whole_cycles(
    loop: Prepared, signal: Signal, points: int = 64, most: int = 400, cut_at: float = 0.0, even_halves: bool = False
) -> WholeCycles:
    """At most ``most`` cycles of a signal, evenly spread, from a crossing upwards to the next.

    A cycle is a positive half wave with the negative one after it, drift off. Each of the ``points`` values is the mean
    of the signal over its share of the cycle, so that many samples a period also mean little noise.  ``cut_at`` is that
    of ``Prepared.wave``; crossings are always those of the smoothed wave.  ``even_halves`` puts as many points on
    either half wave, however long each is.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(1000.0)
    >>> loop = Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t))
    >>> whole_cycles(loop, "PV").y.shape
    (18, 64)
    """
    halves, t = loop.half_waves(signal), loop.stretch.t
    ends = []
    for a, b in itertools.pairwise(halves):
        start, middle = t[a.start] - a.phase[1] * a.length, t[b.start] - b.phase[1] * b.length
        if a.sign > 0.0 and b.sign < 0.0 and abs(start + a.length - middle) < loop.stretch.dt:
            ends.append((start, middle, middle + b.length))
    ends = ends[:: max(-(-len(ends) // most), 1)]
    rows = []
    for start, middle, end in ends:
        edges = np.linspace(start, end, points + 1)
        if even_halves:
            edges = np.interp(np.linspace(0.0, 2.0, points + 1), [0.0, 1.0, 2.0], [start, middle, end])
        rows.append(edges)
    bounds = np.array(ends).reshape(-1, 3)[:, ::2]
    noise = loop.noise(signal) / max(loop.samples_per_period / points, 1.0) ** 0.5
    y = means_between(t, loop.wave(signal, cut_at), np.array(rows).reshape(-1, points + 1))
    return WholeCycles(bounds[:, 0], bounds[:, 1], y, noise)


def means_between(t: Values, y: Values, edges: Values) -> Values:
    """The mean of y (n,) over t (n,) [s] between neighbouring edges (c, m + 1) [s], (c, m).

    >>> t = np.arange(5.0)
    >>> means_between(t, 2 * t, np.array([[0.0, 2.0, 4.0]])).tolist()
    [[2.0, 6.0]]
    """
    area = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])
    return np.asarray(np.diff(np.interp(edges, t, area), axis=1) / np.diff(edges, axis=1))


def averaged(cycles: WholeCycles, noise: float, least: int) -> WholeCycles:
    """Means of neighbouring cycles, with noise of ``noise`` standard deviations or as much as leaves ``least`` of them.

    >>> y = np.sin(np.arange(64) / 10.2)
    >>> many = WholeCycles(np.arange(40.0), np.arange(1.0, 41.0), np.tile(y, (40, 1)), 0.1)
    >>> few = averaged(many, 0.05, 4)
    >>> len(few.y), round(few.noise, 3)
    (5, 0.035)
    """
    spread = float(np.std(cycles.y)) if len(cycles.y) else 0.0
    wanted = math.ceil((cycles.noise / (noise * spread)) ** 2) if spread > 0.0 else 1
    group = max(min(wanted, len(cycles.y) // least), 1)
    kept = len(cycles.y) // group * group
    means = cycles.y[:kept].reshape(-1, group, cycles.y.shape[1]).mean(axis=1)
    return WholeCycles(
        cycles.start[:kept:group], cycles.end[group - 1 : kept : group], means, cycles.noise / group**0.5
    )
