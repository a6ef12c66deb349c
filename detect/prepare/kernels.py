"""The recursions of ``stick`` and ``valve_models`` and the sums of ``lags``, compiled; loaded when first called.

Each runs one candidate after another over the whole OP, so that what it needs stays in the registers.  Compiled once
per machine and kept beside the sources, as the engine's kernels are.
"""

from typing import Any

import numpy as np
from numba import njit

__all__ = ["he_stems", "kano_stems", "polygons", "sticks"]


@njit(cache=True, error_model="numpy")
def sticks(u: Any, S: Any, J: Any, start: Any, eps: float, out: Any) -> None:
    """Stems out (m, n) of OP u (n,) for S, J, start (m,); see ``stick.stick``."""
    for i in range(len(S)):
        static, kinetic = 0.5 * (S[i] + J[i]), 0.5 * (S[i] - J[i])
        moving, stuck = kinetic + eps, static + eps
        here, way, limit = u[0] - start[i] * static, 1.0, static + eps
        for k in range(len(u)):
            over = way * (u[k] - here)
            if over < -stuck:
                way = -way
                here = u[k] - way * kinetic
                limit = moving
            elif over > limit:
                here = u[k] - way * kinetic
                limit = moving
            else:
                limit = stuck
            out[i, k] = here


@njit(cache=True, error_model="numpy")
def kano_stems(u: Any, S: Any, J: Any, way: float, least: float, out: Any) -> None:
    """Stems out (m, n) of Kano's valve; see ``valve_models.kano``."""
    for i in range(len(S)):
        static, kinetic = 0.5 * (S[i] + J[i]), 0.5 * (S[i] - J[i])
        stuck, moving = static + least, kinetic + least
        side, limit = way, moving
        here = u[0] - side * kinetic
        out[i, 0] = here
        for k in range(1, len(u)):
            away = side * (u[k] - here)
            if away < -stuck:
                side = -side
                here = u[k] - side * kinetic
                limit = moving
            elif away > limit:
                here = u[k] - side * kinetic
                limit = moving
            else:
                limit = stuck
            out[i, k] = here


@njit(cache=True, error_model="numpy")
def he_stems(u: Any, S: Any, J: Any, way: float, out: Any) -> None:
    """Stems out (m, n) of He's valve; see ``valve_models.he``."""
    for i in range(len(S)):
        static, kinetic = 0.5 * (S[i] + J[i]), 0.5 * (S[i] - J[i])
        force = way * kinetic
        here = u[0] - force
        out[i, 0] = here
        for k in range(1, len(u)):
            force += u[k] - u[k - 1]
            if abs(force) > static:
                left = kinetic if force > 0.0 else -kinetic
                here += force - left
                force = left
            out[i, k] = here


@njit(cache=True, error_model="numpy")
def polygons(x: Any, knots: Any, integrating: bool, rows: Any, out: Any) -> None:
    """What each corner of the response makes of inputs x (m, n) at the samples ``rows`` (r,): out (m, p, r)."""
    m, n = x.shape
    reach = knots[-1]
    area = np.empty(n + reach + 1)
    slopes = np.empty(len(knots) - 1)
    for i in range(m):
        mean = 0.0
        if integrating:
            for k in range(n):
                mean += x[i, k]
            mean /= n
        once, twice, level = 0.0, 0.0, 0.0
        first = x[i, 0] - mean
        area[0] = 0.0
        for k in range(-reach, n):  # before its start x stands still, and its integral goes on as it began
            if not integrating:
                value = x[i, max(k, 0)]
            elif k < 0:
                value = first + (x[i, 1] - mean) * k
            else:
                level += x[i, k] - mean
                value = level
            once += value
            twice += once
            area[k + reach + 1] = twice
        for r in range(len(rows)):
            at = rows[r] + reach
            for j in range(len(knots) - 1):
                slopes[j] = (area[at - knots[j]] - area[at - knots[j + 1]]) / (knots[j + 1] - knots[j])
            for j in range(len(knots) - 2):
                out[i, j, r] = slopes[j] - slopes[j + 1]
