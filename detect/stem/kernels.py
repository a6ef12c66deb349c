"""The recursions of ``stick`` and ``valve_models`` and the sums of ``lags`` and ``linear_models``, compiled.

Loaded when first called.  Each runs one candidate after another over the whole OP, so that what it needs stays in the
registers.  Compiled once per machine and kept beside the sources, as the engine's kernels are.
"""

from typing import Any

import numpy as np
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _follow(
    u: Any, kinetic: float, stuck: float, moving: float, here: float, way: float, limit: float, out: Any
) -> None:
    """Write one stem into out (n,), from ``here`` on; it moves once OP is ``limit`` ahead or ``stuck`` behind."""
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
        out[k] = here


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def sticks(u: Any, S: Any, J: Any, start: Any, eps: float, out: Any) -> None:
    """Write the stem for each S, J and start (m,), driven by OP u (n,), into out (m, n); see ``stick.stick``."""
    for i in range(len(S)):
        static, kinetic = 0.5 * (S[i] + J[i]), 0.5 * (S[i] - J[i])
        stuck, moving = static + eps, kinetic + eps
        _follow(u, kinetic, stuck, moving, u[0] - start[i] * static, 1.0, stuck, out[i])


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def kano_stems(u: Any, S: Any, J: Any, way: float, least: float, out: Any) -> None:
    """Write the stem of Kano's valve for each S and J (m,) into out (m, n); see ``valve_models.kano``."""
    for i in range(len(S)):
        static, kinetic = 0.5 * (S[i] + J[i]), 0.5 * (S[i] - J[i])
        stuck, moving = static + least, kinetic + least
        out[i, 0] = u[0] - way * kinetic
        _follow(u[1:], kinetic, stuck, moving, out[i, 0], way, moving, out[i, 1:])


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def he_stems(u: Any, S: Any, J: Any, way: float, out: Any) -> None:
    """Write the stem of He's valve for each S and J (m,) into out (m, n); see ``valve_models.he``."""
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


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
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


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def lagged(x: Any, tau_1: float, tau_2: float, width: int, out: Any) -> None:
    """Inputs x (m, n) less their mean, behind two lags [samples], less their moving average over ``width`` samples.

    A lag of 0 is none, one without end an integrator; a width of 0 takes nothing off.  Beyond its ends a signal stands.
    """
    m, n = x.shape
    half = width // 2
    row, total = np.empty(n), np.empty(n + 1)
    a_1, b_1 = 0.0, 1.0
    if tau_1 > 0.0:
        a_1 = np.exp(-1.0 / tau_1)
        b_1 = 1.0 if np.isinf(tau_1) else -np.expm1(-1.0 / tau_1)
    a_2, b_2 = 0.0, 1.0
    if tau_2 > 0.0:
        a_2, b_2 = np.exp(-1.0 / tau_2), -np.expm1(-1.0 / tau_2)
    for i in range(m):
        mean = 0.0
        for k in range(n):
            mean += x[i, k]
        mean /= n
        first, second, before = 0.0, 0.0, 0.0
        for k in range(n):
            now = x[i, k] - mean
            if tau_1 > 0.0:
                first = a_1 * first + b_1 * before  # one sample late, because the input is held
                before = now
            else:
                first = now
            second = a_2 * second + b_2 * first
            row[k] = second
        if width == 0:
            out[i] = row
            continue
        total[0] = 0.0
        for k in range(n):
            total[k + 1] = total[k] + row[k]
        for k in range(n):
            low, high = k - half, k + half + 1
            inside = total[min(high, n)] - total[max(low, 0)]
            inside += max(-low, 0) * row[0] + max(high - n, 0) * row[n - 1]
            out[i, k] = row[k] - inside / width


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def best_delays(x: Any, y: Any, start: int, end: int, delays: int, sign: float, found: Any) -> None:
    """Delay, gain and mean square left of the best of so many delays of x (m, n) for y (n,): found (m, 3).

    Least squares with an offset over the samples from ``start`` to ``end``; a gain against ``sign`` counts as none.
    """
    n = end - start
    mean, square = 0.0, 0.0
    for k in range(start, end):
        mean += y[k]
    mean /= n
    for k in range(start, end):
        square += (y[k] - mean) ** 2
    for i in range(len(x)):
        found[i, 2] = np.inf
        for delay in range(delays):
            sum_x, sum_xx, sum_xy = 0.0, 0.0, 0.0
            for k in range(start - delay, end - delay):
                value = x[i, k]
                sum_x += value
                sum_xx += value * value
                sum_xy += value * (y[k + delay] - mean)
            power = (sum_x / n) ** 2
            spread = sum_xx / n - power
            gain = sum_xy / n / max(spread, 1e-300) if spread > 1e-12 * (spread + power) else 0.0
            if gain * sign < 0.0:
                gain = 0.0
            cost = (square - gain * sum_xy) / n
            if cost < found[i, 2]:
                found[i, 0], found[i, 1], found[i, 2] = delay, gain, cost
