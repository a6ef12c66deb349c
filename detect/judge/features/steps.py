"""How OP and PV move from point to point: steps, stands, and what OP does while PV stays.

Steps are taken over one point, and over a sixth of a turn (wide).  PV stays where its wide step is below a fifth of the
wide steps' spread; Kano's share (2004, method A) counts the points of such stands over which OP travels by a tenth of
its range or more, and OP's travel over them is a direct reading of S.  Yamashita's symbols (2006) count the points at
which OP moves and PV does not, and which of them end in a move the right way.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.moments import kurtosis, skewness
from stickslip.detect.judge.features.view import View

__all__ = ["step_features"]

Values = npt.NDArray[np.float64]


def step_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]."""
    wide = max(round(v.turn / 6.0), 1)
    du, dy = v.u[wide:] - v.u[:-wide], v.y[wide:] - v.y[:-wide]
    bend = dy[wide:] - dy[:-wide]
    found = {
        "op_step_kurtosis": kurtosis(np.diff(v.u)),
        "op_wide_kurtosis": kurtosis(du),
        "op_kurtosis": kurtosis(v.u),
        "op_skewness": abs(skewness(v.u)),
        "pv_step_kurtosis": kurtosis(np.diff(v.y)),
        "pv_wide_kurtosis": kurtosis(dy),
        "pv_bend_kurtosis": kurtosis(bend),
        "e_kurtosis": kurtosis(v.e),
        "e_skewness": abs(skewness(v.e)),
        "op_bend_kurtosis": kurtosis(du[wide:] - du[:-wide]),
        "pv_wide_median": _typical(dy),
        "op_wide_median": _typical(du),
        "pv_bend_median": _typical(bend),
    }
    return found | _stands(v, dy, wide) | _symbols(du, dy, wide)


def _typical(x: Values) -> float:
    """The median step over the root mean square one: 0.67 for a Gaussian, near 0 where few steps make all."""
    return float(np.median(np.abs(x)) / (np.sqrt(np.mean(x**2)) + 1e-12))


def _stands(v: View, dy: Values, wide: int) -> dict[str, float]:
    still = np.abs(dy) < 0.2 * float(np.sqrt(np.mean(dy**2)))
    edges = np.flatnonzero(np.diff(np.concatenate([[0], still.view(np.int8), [0]])))
    starts, ends = edges[::2], edges[1::2] + wide
    travels, lengths = [], []
    for a, b in zip(starts.tolist(), ends.tolist(), strict=True):
        part = v.u[a:b]
        travels.append(float(np.ptp(part)) / v.travel)
        lengths.append(b - a)
    travel, length = np.array(travels), np.array(lengths)
    far = travel >= 0.1
    if not far.any():
        return {"stand_share": 0.0, "stand_travel": math.nan, "stand_scatter": math.nan, "stand_long": math.nan,
                "stand_rate": 0.0}  # fmt: skip
    return {
        "stand_share": float(length[far].sum() / len(v)),
        "stand_travel": float(np.median(travel[far])),
        "stand_scatter": float(np.std(travel[far]) / np.mean(travel[far])),
        "stand_long": float(np.max(length[far]) / v.turn),
        "stand_rate": float(far.sum()) * v.turn / len(v),
    }


def _symbols(du: Values, dy: Values, wide: int) -> dict[str, float]:
    """Yamashita's rho1 and rho2 with steps that do not overlap, and the limit at 0.7 standard deviations."""
    a, b = du[::wide], dy[::wide]
    su = np.where(np.abs(a) > 0.7 * np.std(a), np.sign(a), 0.0)
    sy = np.where(np.abs(b) > 0.7 * np.std(b), np.sign(b), 0.0)
    moving = (su != 0) | (sy != 0)
    n = int(moving.sum())
    if n < 8:
        return {"rho1": math.nan, "rho2": math.nan, "rho_follow": math.nan, "rho_against": math.nan}
    su, sy = su[moving], sy[moving]
    stuck = (su != 0) & (sy == 0)
    ends = np.flatnonzero(stuck[:-1] & ~stuck[1:])
    right = sum(1 for k in ends.tolist() if sy[k + 1] == su[k])
    return {
        "rho1": float(stuck.mean()),
        "rho2": right / n,
        "rho_follow": right / len(ends) if len(ends) else math.nan,
        "rho_against": float(np.mean((su * sy) < 0)),
    }
