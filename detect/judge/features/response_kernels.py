"""The recursion of ``play.responses``, compiled: many lanes through one filter, against PV at several dead times.

    z_t = z_{t-1} + (1 - a)(x_t - z_{t-1}),  once or twice;  or z_t = z_{t-1} + x_t - mean(x)

A lane after the other would wait for its own last value; lanes side by side do not.  Loaded when first called.
"""

from typing import Any

import numpy as np
from stickslip.logs.compiled import njit

__all__ = ["tried"]

PLAIN, ONCE, TWICE, SUMMED = 0, 1, 2, 3


@njit(cache=True, error_model="numpy", fastmath=True)  # type: ignore[untyped-decorator]
def _add(z: Any, w: Any, factor: Any, out: Any) -> None:
    """Add factor z w to ``out``; a loop of its own, so that the compiler takes several lanes at once."""
    for j in range(len(out)):
        out[j] += factor * z[j] * w[j]


@njit(cache=True, error_model="numpy", fastmath=True)  # type: ignore[untyped-decorator]
def tried(
    x: Any, mean: Any, target: Any, load: Any, kind: int, a: Any, shifts: Any, number: int, gain: Any, which: Any
) -> None:
    """Raise ``gain`` (s, c) and set ``which`` (s, c) where one filter with one of the dead times explains more of PV.

    x (m, s, c), mean (s, c), target (n, s) the last n samples of PV less their load, load (n, 2) of length 1,
    ``shifts`` (d,) dead times [samples], ``number`` of the first of them.
    """
    m, s, c = x.shape
    n, dead = len(target), len(shifts)
    one = np.float32(1.0)
    for i in range(s):
        z, w = np.zeros(c, dtype=np.float32), np.zeros(c, dtype=np.float32)
        whole, ones = np.zeros(c, dtype=np.float32), np.ones(c, dtype=np.float32)
        sums = np.zeros((dead, 4, c), dtype=np.float32)  # with PV, itself, the two of the load
        for t in range(m):
            row = x[t, i]
            if kind == PLAIN:
                for j in range(c):
                    z[j] = row[j]
            elif kind == SUMMED:
                for j in range(c):
                    z[j] += row[j] - mean[i, j]
            else:
                for j in range(c):
                    w[j] += (one - a) * (row[j] - w[j])
                if kind == ONCE:
                    for j in range(c):
                        z[j] = w[j]
                else:
                    for j in range(c):
                        z[j] += (one - a) * (w[j] - z[j])
            _add(z, z, one, whole)
            for k in range(dead):
                r = t - (m - n) + shifts[k]
                if 0 <= r < n:
                    _add(z, ones, target[r, i], sums[k, 0])
                    _add(z, z, one, sums[k, 1])
                    _add(z, ones, load[r, 0], sums[k, 2])
                    _add(z, ones, load[r, 1], sums[k, 3])
        for k in range(dead):
            for j in range(c):
                cross, level, along = sums[k, 0, j], sums[k, 2, j], sums[k, 3, j]
                power = max(
                    sums[k, 1, j] - level * level - along * along, np.float32(1e-6) * whole[j] + np.float32(1e-12)
                )
                told = cross * cross / power if cross > 0.0 else np.float32(0.0)
                if told > gain[i, j]:
                    gain[i, j] = told
                    which[i, j] = number + k
