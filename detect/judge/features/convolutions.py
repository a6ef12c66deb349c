"""Convolutions with many kernels and what is pooled of each, compiled; loaded when first called.

    z_t    = sum over channels c and taps k of weight_ck x_c(t + k d)      x_c averaged over d points before
    pooled   share of points at which z (for odd channels |z|) exceeds each of four limits, ln of its root mean square,
             and for odd channels ln of its kurtosis, for even ones mean over root mean square

The averages make a kernel of dilation d blind to noise that is faster than it.
"""

import math
from typing import Any

import numpy as np
from stickslip.logs.compiled import njit

__all__ = ["POOLED", "TAPS", "averaged", "convolved", "pooled", "travelled"]

TAPS = 9
POOLED = 6  # numbers of each kernel
FEWEST = 20  # points of z


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def travelled(u: Any, back: float) -> Any:
    """The travel of u (n,) since it last turned by more than ``back``, with the sign of its way, (n,)."""
    w = np.zeros(len(u))
    way, low, high = 0.0, u[0], u[0]
    start = far = u[0]
    for k in range(len(u)):
        x = u[k]
        if way == 0.0:
            low, high = min(low, x), max(high, x)
            if x - low > back:
                way, start, far = 1.0, low, x
            elif high - x > back:
                way, start, far = -1.0, high, x
        elif way * (x - far) > 0.0:
            far = x
        elif way * (far - x) > back:
            way, start, far = -way, far, x
        w[k] = x - start
    return w


@njit(cache=True, error_model="numpy", fastmath=True)  # type: ignore[untyped-decorator]
def averaged(x: Any, d: int) -> Any:
    """Channels x (c, n) averaged over d points, (c, n - d + 1)."""
    c, n = x.shape
    out = np.empty((c, n - d + 1), np.float32)
    for i in range(c):
        total = 0.0
        for k in range(d):
            total += x[i, k]
        out[i, 0] = total / d
        for k in range(1, n - d + 1):
            total += x[i, k + d - 1] - x[i, k - 1]
            out[i, k] = total / d
    return out


@njit(cache=True, error_model="numpy", fastmath=True)  # type: ignore[untyped-decorator]
def convolved(x: Any, channel: Any, weight: Any, d: int, z: Any) -> Any:
    """Write one kernel's z and return its length; ``channel`` (3,), -1 where unused, ``weight`` (3, TAPS)."""
    n = x.shape[1] - (TAPS - 1) * d
    z[: max(n, 0)] = 0.0
    for j in range(len(channel)):
        if channel[j] < 0:
            continue
        row = x[channel[j]]
        for k in range(TAPS):
            factor, shift = weight[j, k], k * d
            for t in range(n):
                z[t] += factor * row[t + shift]
    return n


@njit(cache=True, error_model="numpy", fastmath=True)  # type: ignore[untyped-decorator]
def pooled(x: Any, d: int, which: Any, channel: Any, weight: Any, limit: Any, odd: bool, z: Any, out: Any) -> None:
    """Write what is pooled of the kernels ``which`` of one dilation to ``out`` (kernels, POOLED), NaN if too short."""
    for i in which:
        n = convolved(x, channel[i], weight[i], d, z)
        if n < FEWEST:
            out[i] = np.nan
            continue
        l0, l1, l2, l3 = limit[i, 0], limit[i, 1], limit[i, 2], limit[i, 3]
        c0 = c1 = c2 = c3 = 0
        first = second = fourth = 0.0
        for t in range(n):
            v = z[t]
            first += v
            if odd:
                v = abs(v)
            c0 += v > l0
            c1 += v > l1
            c2 += v > l2
            c3 += v > l3
            square = v * v
            second += square
            fourth += square * square
        power = second / n + 1e-12
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = c0 / n, c1 / n, c2 / n, c3 / n
        out[i, 4] = 0.5 * math.log(power)
        out[i, 5] = math.log(fourth / n / (power * power) + 1e-12) if odd else first / n / math.sqrt(power)
