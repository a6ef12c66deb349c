"""The closed curves that OP and a form of PV draw, cycle by cycle: how round they are and how wide.

    roundness G = A / (2 pi sqrt(det C)),    S = (R + W) / 2

A is the area inside the curve, C the covariance of its points, R the range of OP and W its travel between the instants
at which the form of PV changes sign.  G is 1 for every ellipse, whatever its axes and its slope, because neither
stretching nor shearing changes it: two sines have G = 1 at any phase.  A rectangle that a triangle (OP) and a square
(PV) draw has G = 2 sqrt(3) / pi = 1.10, a lozenge of two triangles 3 / pi = 0.95.

Where PV stands for the place of the valve, W is the travel of OP from slip to slip.  OP reverses somewhat later than
the valve slips, say by o: then W = S - o and R = S + o, hence S.
"""

import math
from typing import NamedTuple

import numpy as np
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.prepare.whole_cycles import averaged, means_between, whole_cycles
from stickslip.logs.arrays import Values

POINTS = 64
SMOOTHED_AT = 8.0  # times the frequency of the oscillation: corners need the higher harmonics, the means bear the noise


class Loops(NamedTuple):
    """Mean cycles of OP and of the form of PV (g, 64); roundness, range and travel of OP of each (g,) [-, unit, unit].

    ``repeats`` is the share of the variance of the form of PV that returns in every cycle [-].
    """

    op: Values
    pv: Values
    roundness: Values
    range: Values
    travel: Values
    repeats: float

    @property
    def size(self) -> Values:
        """S of each mean cycle [unit of OP], (g,)."""
        return 0.5 * (self.range + self.travel)


def roundness(x: Values, y: Values) -> Values:
    """G of closed curves (g, m), (g,); 0 where a curve has no width.

    >>> turn = 2 * np.pi * np.arange(200) / 200
    >>> round(float(roundness(np.sin(turn)[None], np.sin(turn + 0.3)[None])[0]), 3)
    1.0
    """
    x, y = x - x.mean(axis=1, keepdims=True), y - y.mean(axis=1, keepdims=True)
    area = 0.5 * np.abs(np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1))
    det = (x * x).mean(axis=1) * (y * y).mean(axis=1) - (x * y).mean(axis=1) ** 2
    narrow = det <= 1e-9 * (x * x).mean(axis=1) * (y * y).mean(axis=1)
    return np.asarray(np.where(narrow, 0.0, area / (2.0 * math.pi * np.sqrt(np.where(narrow, 1.0, det)))))


def loops(loop: Prepared, form: Values, shift: float = 0.0, noise: float = 0.05, least: int = 3) -> Loops | None:
    """The curves of OP(t) against form(t + shift) [s], neighbouring cycles averaged; None without ``least`` cycles.

    ``form`` (n,) is PV on the grid of the stretch, turned into what stands for the valve.
    """
    cycles = whole_cycles(loop, "OP", POINTS, cut_at=SMOOTHED_AT)
    inside = cycles.end + shift <= loop.stretch.t[-1]
    start, end = cycles.start[inside], cycles.end[inside]
    if len(start) < least:
        return None
    edges = start[:, None] + (end - start)[:, None] * np.linspace(0.0, 1.0, POINTS + 1)
    pv = means_between(loop.stretch.t, form, edges + shift)
    op = cycles.y[inside]
    mean = averaged(cycles._replace(start=start, end=end, y=op), noise, least)
    group = len(start) // len(mean.y)
    kept = group * len(mean.y)
    means = pv[:kept].reshape(len(mean.y), group, POINTS).mean(axis=1)
    centred = pv - pv.mean(axis=1, keepdims=True)
    repeats = float(np.var(centred.mean(axis=0)) / max(float(np.mean(centred**2)), 1e-300))
    travel = np.array([_travel(a, b) for a, b in zip(mean.y, means, strict=True)])
    return Loops(mean.y, means, roundness(mean.y, means), np.ptp(mean.y, axis=1), travel, repeats)


def _travel(op: Values, pv: Values) -> float:
    """OP between the two main changes of sign of the form of PV, measured from the middle of its range [unit of OP]."""
    pv = pv - 0.5 * (pv.max() + pv.min())
    after = np.roll(pv, -1)
    k = np.flatnonzero((pv > 0.0) != (after > 0.0))
    if len(k) < 2:
        return 0.0
    at = op[k] + (np.roll(op, -1)[k] - op[k]) * pv[k] / (pv[k] - after[k])
    up = after[k] > 0.0
    return float(abs(at[up].mean() - at[~up].mean()))


def tilt(op: Values, pv: Values) -> float:
    """How much the form of PV follows OP between its jumps, over the jump [-]: the median over curves (g, m).

    Least squares of  pv = c + b op + j sign(pv - middle)  in each curve; the tilt is b range(op) / (2 j).

    >>> turn = np.arange(64) / 64
    >>> op, jump = np.abs(2 * turn - 1)[None], np.sign(turn - 0.499)[None]
    >>> round(tilt(op, 3 * jump + 0.6 * op), 3)
    0.1
    """
    found = []
    for x, y in zip(op, pv, strict=True):
        jumps = np.sign(y - 0.5 * (y.max() + y.min()))
        _, b, j = np.linalg.lstsq(np.column_stack([np.ones(len(x)), x, jumps]), y, rcond=None)[0]
        found.append(b * np.ptp(x) / (2.0 * j) if j != 0.0 else math.inf)
    return float(np.median(found))
