"""The stems of a sticky valve behind the OP of a record, for every size, jump and start that the features try.

Each stretch of the record has its own OP, so the recursion of ``prepare.stick`` runs over stretches and candidates side
by side.  The last record's stems are kept, because two families of features look at them.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from detect.judge.features.view import View

__all__ = ["JUMPS", "SIZES", "STARTS", "stems_of", "stick_lanes"]

Values = npt.NDArray[np.float64]

SIZES = np.array((0.08, 0.15, 0.24, 0.34, 0.45, 0.56, 0.67, 0.77, 0.86, 0.94))  # S over the travel of OP
JUMPS = np.array((0.0, 0.4, 1.0))  # J over S
STARTS = np.array((-0.7, 0.7))

_KEPT: WeakKeyDictionary[View, tuple[Values, float]] = WeakKeyDictionary()


def stems_of(v: View) -> tuple[Values, float]:
    """Stems (m, s, c) [-] for m points of s stretches and all c = sizes x jumps x starts, and the travel of OP [-]."""
    if v not in _KEPT:
        u = v.cut(v.u)
        size, ratio, start = (a.ravel() for a in np.meshgrid(SIZES, JUMPS, STARTS, indexing="ij"))
        travel = float(np.median(np.percentile(u, 98, axis=1) - np.percentile(u, 2, axis=1)))
        travel = max(travel, 0.25 * v.travel)  # OP may stand still for most of a stretch
        _KEPT[v] = stick_lanes(u, size * travel, ratio * size * travel, start), travel
    return _KEPT[v]


def stick_lanes(u: Values, S: Values, J: Values, start: Values) -> Values:
    """``prepare.stick.stick`` with an OP of its own for every stretch u (s, m): stems (m, s, c)."""
    s, m = u.shape
    static, kinetic = 0.5 * (S + J), 0.5 * (S - J)
    eps = 1e-9 * float(np.ptp(u))
    x = np.empty((m, s, len(S)))
    here = u[:, :1] - start * static
    way = np.ones_like(here)
    shape = here.shape
    stuck, moving = np.broadcast_to(static + eps, shape), np.broadcast_to(kinetic + eps, shape)
    limit, push = stuck, way * kinetic
    for k in range(m):
        op = u[:, k : k + 1]
        over = way * (op - here)
        back = over < -stuck
        if back.any():
            way = np.where(back, -way, way)
            push = way * kinetic
            over = np.where(back, -over, over)
        go = back | (over > limit)
        here = np.where(go, op - push, here)
        limit = np.where(go, moving, stuck)
        x[k] = here
    return x
