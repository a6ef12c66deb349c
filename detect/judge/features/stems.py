"""The stems of a sticky valve behind the OP of a record, for every size, jump and start that the features try.

Each stretch of the record has its own OP.  The last record's stems are kept, because two families of features look at
them.
"""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View

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
    from stickslip.detect.prepare.kernels import sticks

    s, m = u.shape
    eps = 1e-9 * float(np.ptp(u))
    x = np.empty((s, len(S), m))
    for own, stems in zip(u, x, strict=True):
        sticks(np.ascontiguousarray(own), S, J, start, eps, stems)
    return np.ascontiguousarray(x.transpose(2, 0, 1))
