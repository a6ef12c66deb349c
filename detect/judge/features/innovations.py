"""What is new in PV at each point, given the past of PV and of OP or of a stem: one step ahead, noise included.

    y(t) = a1 y(t-1) + a2 y(t-2) + a3 y(t-3) + sum over lags of b x(t - lag) + c + innovation

With OP (x = u), with the stem of a stick (x), and with both, by least squares on every stretch.  Where the valve
sticks, the stem tells more than OP, OP adds nothing to the stem, and the innovations under OP are few and large: the
slips.  The travel of OP from one slip to the next is then the same each time.  An outside wave leaves OP its say.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.moments import kurtosis
from stickslip.detect.judge.features.stems import JUMPS, SIZES, STARTS, stems_of
from stickslip.detect.judge.features.view import View

__all__ = ["innovation_features"]

Values = npt.NDArray[np.float64]
LAGS = (1, 2, 3, 5)
DEEP = 5


def innovation_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]."""
    u, y = v.cut(v.u), v.cut(v.y)
    s, m = u.shape
    stems, travel = stems_of(v)
    shape = (len(SIZES), len(JUMPS), len(STARTS))
    by_op, alone, both, left = np.empty(s), np.empty((s, *shape)), np.empty((s, *shape)), np.empty((s, m - DEEP))
    own = np.empty(s)
    for k in range(s):
        by_op[k], own[k], left[k], one, two = _losses(u[k], y[k], stems[:, k])
        alone[k], both[k] = one.reshape(shape), two.reshape(shape)
    first = np.argmin(np.log(alone).sum(axis=0).min(axis=2))
    i, j = divmod(int(first), len(JUMPS))
    at = alone.min(axis=3)[:, i, j]
    at_both = both.min(axis=3)[:, i, j]
    n = s * (m - DEEP)
    found = {
        "arx_gain": float(np.mean(np.log(by_op / at))),
        "arx_gain_min": float(np.min(np.log(by_op / at))),
        "arx_f": 0.5 * n * float(np.mean(np.log(by_op / at))) / math.sqrt(n),
        "arx_stem_adds": float(np.mean(np.log(by_op / at_both))),
        "arx_op_adds": float(np.mean(np.log(at / at_both))),
        "arx_op_tells": float(np.mean(np.log(own / by_op))),
        "arx_stem_tells": float(np.mean(np.log(own / at))),
        "arx_size": float(SIZES[i]),
        "arx_jump": float(JUMPS[j]),
        "arx_size_scatter": float(np.std(np.log(SIZES[np.argmin(alone.min(axis=(2, 3)), axis=1)]))),
        "arx_jump_gain": float(np.mean(np.log(alone[..., 0, :].min(axis=(1, 2)) / alone.min(axis=(1, 2, 3))))),
    }
    return found | _events(v, u, left, travel)


def _losses(u: Values, y: Values, stems: Values) -> tuple[float, float, Values, Values, Values]:
    """Mean squares left with OP, with PV alone, the innovations under OP, and with each stem, alone and beside OP."""
    m, c = stems.shape
    past = [y[DEEP - k : m - k] for k in (1, 2, 3)]
    target = y[DEEP:]
    ones = np.ones(m - DEEP)
    op = [u[DEEP - k : m - k] for k in LAGS]
    base = np.column_stack([ones, *past])
    q, _ = np.linalg.qr(base)
    target = target - q @ (q.T @ target)
    op_columns = np.column_stack(op)
    op_columns = op_columns - q @ (q.T @ op_columns)
    own = max(float(target @ target), 1e-12)
    w, _ = np.linalg.qr(op_columns)
    left = target - w @ (w.T @ target)
    columns = np.stack([stems[DEEP - k : m - k] for k in LAGS], axis=1)  # (m', 4, c)
    flat = columns.reshape(m - DEEP, -1)
    flat = flat - q @ (q.T @ flat)
    alone = own - _told(flat.reshape(m - DEEP, len(LAGS), c), target)
    beside = flat - w @ (w.T @ flat)
    rest = max(float(left @ left), 1e-12)
    both = rest - _told(beside.reshape(m - DEEP, len(LAGS), c), left)
    floor = 1e-6 * own
    return max(rest, floor), own, left, np.maximum(alone, floor), np.maximum(both, floor)


def _told(columns: Values, target: Values) -> Values:
    """What least squares on the columns (m, p, c) of each candidate tell of the target (m,), (c,)."""
    p = columns.shape[1]
    lanes = np.ascontiguousarray(columns.transpose(2, 1, 0))  # (c, p, m)
    gram = lanes @ lanes.transpose(0, 2, 1)
    cross = lanes @ target
    ridge = 1e-8 * np.trace(gram, axis1=1, axis2=2) + 1e-12
    gram[:, range(p), range(p)] += ridge[:, None]
    weights = np.linalg.solve(gram, cross[:, :, None])[:, :, 0]
    return np.asarray(np.einsum("cp,cp->c", weights, cross))


def _events(v: View, u: Values, left: Values, travel: float) -> dict[str, float]:
    """Large innovations: how rare, how large, and how far OP went from one to the next."""
    sigma = 1.4826 * float(np.median(np.abs(left))) + 1e-9 * float(np.max(np.abs(left))) + 1e-12
    squares = np.sort((left**2).ravel())[::-1]
    top = max(len(squares) // 20, 1)
    found = {
        "new_kurtosis": kurtosis(left.ravel()),
        "new_top_share": float(squares[:top].sum() / squares.sum()) if squares.sum() > 0.0 else math.nan,
        "new_noise": sigma,
        "new_white": float(np.mean(left[:, 1:] * left[:, :-1]) / (np.mean(left**2) + 1e-300)),
    }
    went, signs, gaps, agree, size = [], [], [], [], []
    back = max(round(0.3 * v.turn), 1)
    before = u[:, DEEP - 1 : -1] - u[:, np.maximum(np.arange(DEEP - 1, u.shape[1] - 1) - back, 0)]
    cubes = left**3
    found["new_agree"] = float(np.sum(cubes * before) / (np.sum(np.abs(cubes * before)) + 1e-300))
    found["new_agree_sign"] = float(np.sum(cubes * np.sign(before)) / (np.sum(np.abs(cubes)) + 1e-300))
    for op, new in zip(u[:, DEEP:], left, strict=True):
        at = _peaks(new, 2.7 * sigma, max(round(0.15 * v.turn), 1))
        if len(at) < 2:
            continue
        moves = np.diff(op[at])
        went.append(moves / travel)
        signs.append(np.sign(new[at[1:]]))
        gaps.append(np.diff(at))
        agree.append(np.sign(op[at] - op[np.maximum(at - back, 0)]) * np.sign(new[at]))
        size.append(np.abs(new[at]))
    names = ("rate", "travel", "travel_scatter", "turns", "agree", "gap_scatter", "size_scatter", "towards")
    if not went:
        return found | {f"slip_{name}": math.nan for name in names} | {"slip_rate": 0.0}
    move, sign, gap = np.concatenate(went), np.concatenate(signs), np.concatenate(gaps)
    far, sizes = np.abs(move), np.concatenate(size)
    found |= {
        "slip_rate": len(move) * v.turn / left.size,
        "slip_travel": float(np.median(far)),
        "slip_travel_scatter": float(np.std(far) / (np.mean(far) + 1e-9)),
        "slip_turns": float(np.mean(sign[1:] != sign[:-1])) if len(sign) > 1 else math.nan,
        "slip_agree": float(np.mean(np.concatenate(agree))),
        "slip_gap_scatter": float(np.std(gap) / np.mean(gap)),
        "slip_size_scatter": float(np.std(sizes) / np.mean(sizes)),
        "slip_towards": float(np.mean(np.sign(move) * sign)),
    }
    return found


def _peaks(x: Values, limit: float, apart: int) -> npt.NDArray[np.intp]:
    """Where |x| exceeds the limit, the largest of each group that lies within ``apart`` points, in order."""
    over = np.flatnonzero(np.abs(x) > limit)
    if not len(over):
        return over
    groups = np.split(over, np.flatnonzero(np.diff(over) > apart) + 1)
    return np.array([g[np.argmax(np.abs(x[g]))] for g in groups], dtype=np.intp)
