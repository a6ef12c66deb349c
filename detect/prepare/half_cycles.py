"""Half cycles of an oscillating signal: where it crosses its centre, where it peaks, the area on either side.

Crossings and peaks lie between samples; both are interpolated, and the areas are cut there:

    A1 = area from the zero crossing to the peak,    A2 = area from the peak to the next crossing

Works on uneven sampling throughout: areas are trapezoids of the polygon through the samples, the interpolated
crossings and the interpolated peak.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["HalfCycle", "crossings", "measure"]

Values = npt.NDArray[np.float64]

FLAT_SHARE = 0.6  # a sine spends 29 % of its half period above 90 % of its peak, a triangle 10 %, a square 100 %
TWO_PEAKS = 0.2  # tops apart by more than this share of the half cycle are two peaks
KINK = 1.8  # slope break at a corner over the break that smooth curvature beside it explains (1 = smooth)
SAMPLES_MIN = 5


@dataclass(frozen=True)
class HalfCycle:
    """One half cycle between two zero crossings.

    start, peak_time, end : float [s]
    peak : float
        Signed height [unit of the signal].
    area_before, area_after : float
        A1 and A2, both positive [unit s].
    samples : int
        Samples between the crossings.
    sine_misfit, triangle_misfit : float
        Squared distance to the best sine and the best triangle on the same base [unit^2 s].
    fault : str
        "" or why it cannot be used: "short", "flat", "two_peaks".
    """

    start: float
    peak_time: float
    end: float
    peak: float
    area_before: float
    area_after: float
    samples: int
    sine_misfit: float
    triangle_misfit: float
    fault: str = ""

    @property
    def length(self) -> float:
        """Time between the crossings [s]."""
        return self.end - self.start


def crossings(t: Values, x: Values, band: float | Values = 0.0) -> Values:
    """Times [s] at which x changes sign for good, shape (m,).

    A change counts when x leaves -band on one side and +band on the other (hysteresis; one band for all samples or one
    for each). Between the two the noisy signal may cross zero several times; the middle between its first and last
    crossing is taken.

    >>> crossings(np.array([0.0, 1, 2, 3]), np.array([-1.0, 1, 3, -1])).tolist()
    [0.5, 2.75]
    """
    firm = np.flatnonzero(np.abs(x) > band)
    if len(firm) < 2:
        return np.empty(0)
    positive = x[firm] > 0
    flips = np.flatnonzero(positive[1:] != positive[:-1])
    times = []
    for i, j in zip(firm[flips], firm[flips + 1], strict=True):
        a, b = x[i:j], x[i + 1 : j + 1]
        k = np.flatnonzero((a > 0) != (b > 0))
        where = t[i:j][k] + (t[i + 1 : j + 1] - t[i:j])[k] * a[k] / (a[k] - b[k])
        times.append(0.5 * (where[0] + where[-1]))
    return np.asarray(times)


def measure(t: Values, x: Values, start: float, end: float, noise: float = 0.0) -> HalfCycle:
    """The half cycle of x between the crossings ``start`` and ``end`` [s].

    Parameters: ``t``, ``x`` ((n,)) The signal, reaching beyond the half cycle if it can; x centred on its baseline;
    ``noise`` (float) Noise left in x [unit of x]. Samples within one ``noise`` of the highest are the top, and the peak
    is the centre of the top weighted by height; without noise it is interpolated between samples.

    A corner is found as the crossing of the lines beside it, a round peak as the vertex of the parabola
    through three samples; see ``_vertex``.
    """
    lo, hi = int(np.searchsorted(t, start, "right")), int(np.searchsorted(t, end, "left"))
    samples = hi - lo
    if samples < SAMPLES_MIN:
        return HalfCycle(start, 0.5 * (start + end), end, 0.0, 0.0, 0.0, samples, 0.0, 0.0, "short")
    sign = 1.0 if np.sum(x[lo:hi]) >= 0 else -1.0
    y = sign * x
    best = lo + int(np.argmax(y[lo:hi]))
    height = float(y[best])
    fault = ""
    top = lo + np.flatnonzero(y[lo:hi] >= height - max(noise, 1e-9 * height))
    jumps = np.diff(t[top])[np.diff(top) > 1]
    if len(jumps) and np.max(jumps) > TWO_PEAKS * (end - start):
        fault = "two_peaks"
    if len(top) > 2:
        excess = y[top] - height + max(noise, 1e-9 * height)
        weight = excess * 0.5 * (t[np.minimum(top + 1, len(t) - 1)] - t[top - 1])
        peak_time, peak = float(np.sum(weight * t[top]) / np.sum(weight)), height
    else:
        peak_time, peak = _vertex(t, y, best)
    peak_time = min(max(peak_time, start), end)
    s = np.concatenate([[start], t[lo:hi], [end]])
    v = np.concatenate([[0.0], y[lo:hi], [0.0]])
    if _flat_share(s, v, height) > FLAT_SHARE:
        fault = "flat"
    before = _area(s, v, start, peak_time, peak)
    after = _area(s, v, peak_time, end, peak)
    sine, triangle = _misfits(s, v, start, end)
    if before <= 0 or after <= 0:
        fault = fault or "short"
    return HalfCycle(start, peak_time, end, sign * peak, before, after, samples, sine, triangle, fault)


def _vertex(t: Values, y: Values, k: int) -> tuple[float, float]:
    """Time and height of the peak near its highest sample k.

    The lines through the two samples on either side meet in a corner (exact for a triangle, near exact for an
    exponential); the parabola through three samples is exact for a round top. The corner is believed when the
    slope breaks there by more than KINK times what the curvature on either side would explain.
    """
    if k < 1 or k > len(t) - 2:
        return float(t[k]), float(y[k])
    corner = max(_corner(t, y, k - 1), _corner(t, y, k))
    if corner[0] > KINK:
        return corner[1], max(corner[2], float(y[k]))
    # Newton form of the parabola through k-1, k, k+1; its vertex is where the slope vanishes.
    d0, d1 = t[k] - t[k - 1], t[k + 1] - t[k]
    s0, s1 = (y[k] - y[k - 1]) / d0, (y[k + 1] - y[k]) / d1
    bend = (s1 - s0) / (d0 + d1)
    if bend >= 0:
        return float(t[k]), float(y[k])
    when = min(max(0.5 * (t[k - 1] + t[k]) - 0.5 * s0 / bend, t[k - 1]), t[k + 1])
    return float(when), float(y[k - 1] + (when - t[k - 1]) * (s0 + bend * (when - t[k])))


def _corner(t: Values, y: Values, a: int) -> tuple[float, float, float]:
    """How sharp a corner between samples a and a + 1 would be, its time and its height; sharpness 0 is none."""
    if a < 2 or a + 3 >= len(t):
        return 0.0, 0.0, 0.0
    slope = np.diff(y[a - 2 : a + 4]) / np.diff(t[a - 2 : a + 4])
    left, right = float(slope[1]), float(slope[3])
    if left <= right:
        return 0.0, 0.0, 0.0
    # The sides are curved: their slopes at the corner are extrapolated from the two secants on either side.
    bend_left = (left - float(slope[0])) / (t[a] - t[a - 2])
    bend_right = (float(slope[4]) - right) / (t[a + 3] - t[a + 1])
    when, rise, fall = 0.5 * float(t[a] + t[a + 1]), left, right
    for _ in range(4):
        rise = left + bend_left * (when - float(t[a - 1]))
        fall = right + bend_right * (when - float(t[a + 2]))
        if rise <= fall:
            return 0.0, 0.0, 0.0
        when = float(t[a] + (y[a + 1] - y[a] - fall * (t[a + 1] - t[a])) / (rise - fall))
    slack = 0.2 * float(t[a + 1] - t[a])  # a corner on a sample may come out just beside it
    if not t[a] - slack <= when <= t[a + 1] + slack:
        return 0.0, 0.0, 0.0
    smooth = 2 * max(abs(slope[0] - slope[1]), abs(slope[3] - slope[4]))
    sharpness = (left - right) / max(float(smooth), 1e-12 * (left - right))
    return sharpness, when, float(y[a] + rise * (when - t[a]))


def _area(s: Values, v: Values, a: float, b: float, peak: float) -> float:
    """Area under the polygon (s, v) between a and b, one of which is the peak."""
    inside = (s > a) & (s < b)
    ends = [0.0 if a == s[0] else peak, 0.0 if b == s[-1] else peak]
    time = np.concatenate([[a], s[inside], [b]])
    value = np.concatenate([[ends[0]], v[inside], [ends[1]]])
    return float(np.sum(0.5 * (value[1:] + value[:-1]) * np.diff(time)))


def _flat_share(s: Values, v: Values, height: float) -> float:
    """Share of the half cycle spent above 90 % of its height."""
    high = (v > 0.9 * height).astype(float)
    return float(np.sum(0.5 * (high[1:] + high[:-1]) * np.diff(s)) / (s[-1] - s[0]))


def _misfits(s: Values, v: Values, start: float, end: float) -> tuple[float, float]:
    phase = (s - start) / (end - start)
    weight = np.gradient(s)
    total = float(np.sum(weight * v * v))
    left = []
    for shape in (np.sin(np.pi * phase), 1 - np.abs(2 * phase - 1)):
        dot, norm = float(np.sum(weight * v * shape)), float(np.sum(weight * shape * shape))
        left.append(max(total - dot * dot / norm, 0.0))
    return left[0], left[1]
