"""The sums of ``smoothing``, compiled: averages under a polygon, and noise by the cubic through four neighbours.

Loaded when first called.  Windows come in order, so that two walks along the polygon, one for either end, find all.
"""

from typing import Any

import numpy as np
from stickslip.detect.signals.order_kernels import median
from stickslip.logs.compiled import njit

EVEN = 1e-9  # of a step, by which the steps of an even clock may differ
WHITE = 0.6744897501960817  # median of |x| over the standard deviation, of white noise


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _area(t: Any, x: Any, area: Any, k: int, q: float) -> tuple[float, int]:
    """Area under the polygon from its start to q [s after it], and the piece that q lies in, which is k or a later."""
    while k < len(t) - 2 and t[k + 1] - t[0] <= q:
        k += 1
    s = q - (t[k] - t[0])
    slope = (x[k + 1] - x[k]) / (t[k + 1] - t[k])
    return area[k] + s * (x[k] + 0.5 * slope * s), k


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def averages(t: Any, x: Any, width: float, held: bool, out: Any) -> None:
    """Averages of the polygon (t, x) over ``width`` [s] about each sample, into out (n,); see ``moving_average``."""
    n = len(t)
    area = np.empty(n)
    area[0] = 0.0
    for i in range(1, n):
        area[i] = area[i - 1] + 0.5 * (x[i] + x[i - 1]) * (t[i] - t[i - 1])
    end = t[n - 1] - t[0]
    low, high = 0, 0
    for i in range(n):
        centre = t[i] - t[0]
        half = 0.5 * (min(width, end) if held else min(width, 2.0 * min(centre, end - centre)))
        if held:
            centre = min(max(centre, half), end - half)
        if half <= 0.0:
            out[i] = x[i]
            continue
        first, low = _area(t, x, area, low, centre - half)
        last, high = _area(t, x, area, high, centre + half)
        out[i] = (last - first) / (2.0 * half)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _off_cubic(t: Any, x: Any, out: Any) -> None:
    """|x - cubic through the two samples on either side|, in standard deviations of unit noise, into out (n - 4,)."""
    for m in range(2, len(t) - 2):  # as on an even clock: weights -1/6, 2/3, 2/3, -1/6, their squares add up to 17/18
        out[m - 2] = abs(x[m] - (4.0 * (x[m - 1] + x[m + 1]) - (x[m - 2] + x[m + 2])) / 6.0) / (35.0 / 18.0) ** 0.5
    for m in range(2, len(t) - 2):
        step = t[m + 1] - t[m]
        uneven = abs(t[m] - t[m - 1] - step) + abs(t[m - 1] - t[m - 2] - step) + abs(t[m + 2] - t[m + 1] - step)
        if uneven <= EVEN * step:
            continue
        prediction, spread = 0.0, 1.0
        for i in (m - 2, m - 1, m + 1, m + 2):
            weight = 1.0
            for j in (m - 2, m - 1, m + 1, m + 2):
                if j != i:
                    weight *= (t[m] - t[j]) / (t[i] - t[j])
            prediction += weight * x[i]
            spread += weight**2
        out[m - 2] = abs(x[m] - prediction) / spread**0.5


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def noise(t: Any, x: Any) -> Any:
    """Standard deviation of the white noise on x (n,); see ``smoothing.noise_std``."""
    if len(t) < 7:
        return 0.0
    off = np.empty(len(t) - 4)
    _off_cubic(t, x, off)
    return median(off) / WHITE
