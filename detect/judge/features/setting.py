"""What the record and the controller are like: sampling, noise, resolution, limits, drift, set point, controller.

None of these says that a valve sticks; they say what the other features are worth on this record.

    controller     du = K (de + e dt / T_i), by least squares over the points: T_i in turns, and how well it tells du
    drift          OP from the first tenth to the last over its range
    resolution     the record's own smallest step of PV (OP) over its range, where it lives on a grid
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View

__all__ = ["setting_features"]

Values = npt.NDArray[np.float64]


def setting_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]; logarithms to base 10 where a ratio spans decades."""
    n = len(v)
    tenth = max(n // 10, 1)
    range_y = float(np.subtract(*np.percentile(v.raw_y, (99, 1)))) + 1e-12
    range_u = float(np.subtract(*np.percentile(v.raw_u, (99, 1)))) + 1e-12
    steps_y, steps_u = np.diff(v.raw_y), np.diff(v.raw_u)
    t = np.linspace(-1.0, 1.0, n)
    slope = float(t @ v.u) / float(t @ t)
    found = {
        "turns": math.log10(n / v.turn),
        "samples_per_turn": math.log10(v.turn * v.block),
        "noise": math.log10(v.noise / range_y + 1e-5),
        "stale": v.stale,
        "pv_held": float(np.mean(steps_y == 0.0)),
        "op_held": float(np.mean(steps_u == 0.0)),
        "pv_grid": _grid(v.raw_y, steps_y, range_y),
        "op_grid": _grid(v.raw_u, steps_u, range_u),
        "pv_drawn": _drawn(v.raw_y),
        "op_drawn": _drawn(v.raw_u),
        "op_high": float(np.mean(v.raw_u >= v.raw_u.max() - 1e-6 * range_u)),
        "op_low": float(np.mean(v.raw_u <= v.raw_u.min() + 1e-6 * range_u)),
        "drift": abs(float(v.u[-tenth:].mean() - v.u[:tenth].mean())) / v.travel,
        "ramp": slope**2 * float(t @ t) / (float(np.sum((v.u - v.u.mean()) ** 2)) + 1e-12),
        "op_peaks": float(np.ptp(v.raw_u)) / range_u,
        "pv_peaks": float(np.ptp(v.raw_y)) / range_y,
        "integrating": math.nan if v.integrating is None else float(v.integrating),
        "error_share": min(float(np.std(v.e) / (np.std(v.y) + 1e-12)), 10.0),
    }
    return found | _set_point(v) | _controller(v)


def _grid(x: Values, steps: Values, width: float) -> float:
    """log10 of levels across the range if the values live on a grid; NaN if not."""
    size = np.abs(steps[np.abs(steps) > 1e-9])
    if len(size) < 5:
        return math.nan
    step = float(np.percentile(size, 1))
    off = (x - x[0]) / step
    gridded = float(np.mean(np.abs(off - np.round(off)) < 0.05))
    return math.log10(width / step) if gridded >= 0.9 else math.nan


def _drawn(x: Values) -> float:
    """Share of samples on the straight line between their neighbours, those that merely hold left out."""
    bend, step = np.abs(x[2:] - 2 * x[1:-1] + x[:-2]), np.abs(x[2:] - x[:-2])
    return float(np.mean((bend < 1e-6 * np.ptp(x)) & (step > 1e-6 * np.ptp(x))))


def _set_point(v: View) -> dict[str, float]:
    if v.sp is None:
        return {"sp_size": 0.0, "sp_moves": 0.0, "sp_pv": math.nan}
    moves = np.abs(np.diff(v.sp)) > 1e-9
    return {
        "sp_size": min(float(np.std(v.sp) / (np.std(v.y) + 1e-12)), 10.0),
        "sp_moves": float(np.mean(moves)),
        "sp_pv": float(np.corrcoef(v.sp, v.y)[0, 1]) if np.std(v.sp) > 1e-12 else math.nan,
    }


def _controller(v: View) -> dict[str, float]:
    """The settings that the points betray, and how well a PI tells OP's steps (not where a derivative acts)."""
    du, de, e = np.diff(v.u), np.diff(v.e), 0.5 * (v.e[1:] + v.e[:-1])
    columns = np.column_stack([de, e - e.mean()])
    gram = columns.T @ columns + 1e-9 * np.eye(2)
    proportional, integral = np.linalg.solve(gram, columns.T @ du)
    left = du - columns @ np.array([proportional, integral])
    ratio = proportional / integral if abs(integral) > 1e-12 else math.inf
    return {
        "controller_told": 1.0 - float(left @ left) / (float(du @ du) + 1e-12),
        "controller_ti": math.log10(min(max(ratio / v.turn, 1e-3), 1e3)) if ratio > 0 else -3.0,
        "controller_gain": math.log10(min(max(float(abs(proportional)), 1e-4), 1e4)),
    }
