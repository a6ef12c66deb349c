"""The mean cycle of OP and PV: all cycles of OP, one over the other, so that noise is less by the root of their number.

Cycles run from one rising crossing of OP to the next and are read at 32 phases; those of 0.6 to 1.6 times the median
length count.  On the mean cycle, repeated, a play is fitted as on the record (``play``), and the harmonics are taken:

    h2, h3   amplitude of the second and third harmonic over the first (triangle 1/9, square 1/3 at the third)
    c3       cosine of arg a3 - 3 arg a1: +1 triangle, -1 square
    shift    by how many turns the first harmonic of PV is behind that of OP
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.play import responses
from stickslip.detect.judge.features.shapes import crossings_of
from stickslip.detect.judge.features.stems import JUMPS, SIZES, stick_lanes
from stickslip.detect.judge.features.view import View

__all__ = ["fold", "fold_features"]

Values = npt.NDArray[np.float64]
PHASES = np.arange(32) / 32
LEAST = 3  # cycles
REPEATED = 4
SIGNALS = ("op", "pv", "slope")
HARMONIC = ("h2", "h3", "c3", "told")
FITTED = ("ratio", "r2", "size", "size_mean", "jump", "jump_gain", "small", "large", "lag")


def fold(v: View) -> tuple[Values, Values, float, float, int] | None:
    """Mean cycle of u and of y, (32,), the shares of their variance that it explains [-], and the number of cycles."""
    at = crossings_of(v.u, v.turn)[0]
    rising = at[0::2] if len(at) else at
    length = np.diff(rising)
    if len(length) < LEAST:
        return None
    middle = float(np.median(length))
    good = (length > 0.6 * middle) & (length < 1.6 * middle)
    if good.sum() < LEAST:
        return None
    times = rising[:-1][good, None] + length[good, None] * PHASES
    n = np.arange(len(v))
    waves, told = [], []
    for x in (v.u, v.y):
        cycles = np.interp(times, n, x)
        cycles = cycles - cycles.mean(axis=1, keepdims=True)
        mean = cycles.mean(axis=0)
        waves.append(mean)
        told.append(float(np.sum(mean**2) * len(cycles) / (np.sum(cycles**2) + 1e-12)))
    return waves[0], waves[1], told[0], told[1], int(good.sum())


def fold_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]; NaN for fewer than three cycles."""
    names = [f"fold_{s}_{h}" for s in SIGNALS for h in HARMONIC if (s, h) != ("slope", "told")]
    names += ["fold_shift", "fold_count", *[f"fold_{f}" for f in FITTED]]
    found = fold(v)
    if found is None:
        return dict.fromkeys(names, math.nan)
    u, y, told_u, told_y, count = found
    slope = np.roll(y, -1) - np.roll(y, 1)
    values: list[float] = []
    first = []
    for x, told in ((u, told_u), (y, told_y), (slope, None)):
        a = np.fft.rfft(x)[1:4]
        first.append(a[0])
        one = abs(a[0]) + 1e-12
        values += [abs(a[1]) / one, abs(a[2]) / one, math.cos(float(np.angle(a[2]) - 3 * np.angle(a[0])))]
        if told is not None:
            values.append(told)
    shift = float(np.angle(first[0] * np.conj(first[1]))) / math.pi % 2.0
    return dict(zip(names, [*values, shift, math.log10(count), *_played(u, y)], strict=True))


def _played(u: Values, y: Values) -> list[float]:
    size, ratio = (a.ravel() for a in np.meshgrid(SIZES, JUMPS, indexing="ij"))
    op = np.tile(u, REPEATED)[None]
    travel = float(np.ptp(u))
    stems = stick_lanes(op, size * travel, ratio * size * travel, np.zeros(len(size)))
    lanes = np.concatenate([op.T[:, :, None], stems], axis=2).astype(np.float32)
    loss, which, tss = responses(lanes, np.tile(y, REPEATED)[None].astype(np.float32), 16.0, settle=64)
    loss = (loss / tss[:, None])[0]
    table = loss[1:].reshape(len(SIZES), len(JUMPS))
    i, j = np.unravel_index(int(np.argmin(table)), table.shape)
    best, by_size, by_jump = float(table[i, j]), table.min(axis=1), table.min(axis=0)
    weight = np.exp(-8.0 * np.log(by_size / best))
    return [
        math.log(float(loss[0]) / best), 1.0 - best, float(SIZES[i]), float(weight @ SIZES / weight.sum()),
        float(JUMPS[j]), math.log(by_jump[0] / by_jump[1:].min()), math.log(by_size[0] / best),
        math.log(by_size[-1] / best), float(which[0, 1 + i * len(JUMPS) + j]),
    ]  # fmt: skip
