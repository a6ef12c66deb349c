"""The sums of ``smoothing``, compiled: areas under a polygon, and what each sample is off the cubic of its neighbours.

Loaded when first called.  Times to which an area is asked come in order, so that one walk along the polygon finds all.
"""

from typing import Any

from numba import njit

__all__ = ["areas_to", "off_cubic"]


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def areas_to(t: Any, x: Any, area: Any, q: Any, out: Any) -> None:
    """Areas under the polygon (t, x) from its start to the times q (m,), which increase, into out (m,)."""
    k = 0
    for i in range(len(q)):
        while k < len(t) - 2 and t[k + 1] <= q[i]:
            k += 1
        s = q[i] - t[k]
        slope = (x[k + 1] - x[k]) / (t[k + 1] - t[k])
        out[i] = area[k] + s * (x[k] + 0.5 * slope * s)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def off_cubic(t: Any, x: Any, out: Any) -> None:
    """|x - cubic through the two samples on either side|, in standard deviations of unit noise, into out (n - 4,)."""
    for m in range(2, len(t) - 2):
        prediction, spread = 0.0, 1.0
        for i in (m - 2, m - 1, m + 1, m + 2):
            weight = 1.0
            for j in (m - 2, m - 1, m + 1, m + 2):
                if j != i:
                    weight *= (t[m] - t[j]) / (t[i] - t[j])
            prediction += weight * x[i]
            spread += weight**2
        out[m - 2] = abs(x[m] - prediction) / spread**0.5
