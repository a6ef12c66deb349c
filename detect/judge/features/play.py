"""Play and stick between OP and PV against the same lag without: the fits, on every stretch with a start of its own.

    x      stem for OP u, each S, J / S and start (``prepare.stick``)
    y      = b G(q) x + c + d t,   b >= 0,   G one lag, two equal lags or an integrator, each with dead time
    loss   sum of squares left, least over G and start

OP itself (S = 0) has the same G to choose from.  With feedback a play adds phase lag, which a poor bank of lags would
reward; hence two orders and dead times on both sides.  The loss of each S and J / S is summed over the stretches, so
that one valve has to tell all of them; how far the best S of single stretches lie apart is a feature of its own.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.stems import JUMPS, SIZES, STARTS, stems_of
from stickslip.detect.judge.features.view import View

__all__ = ["play_features"]

Values = npt.NDArray[np.float64]
Lanes = npt.NDArray[np.float32]

LAGS = (0.0, 0.08, 0.2, 0.45, 1.0, 2.2)  # time constants [turns]
HIDDEN = (1, 3, 8)  # fall of the log-likelihood, one look a turn
DELAYS = (0.0, 0.08, 0.2, 0.4)  # dead times [turns]


def play_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]."""
    u, y = v.cut(v.u), v.cut(v.y)
    s, m = u.shape
    stems, travel = stems_of(v)
    lanes = np.concatenate([u.T[:, :, None], stems], axis=2).astype(np.float32)
    loss, which, tss = responses(lanes, y.astype(np.float32), v.turn)
    loss /= tss.sum()
    linear, lag = loss[:, 0], which[:, 0]
    table = loss[:, 1:].reshape(s, len(SIZES), len(JUMPS), len(STARTS)).min(axis=3)
    total = table.sum(axis=0)
    i, j = np.unravel_index(int(np.argmin(total)), total.shape)
    best = float(total[i, j])
    each = table.min(axis=2)  # by stretch and size
    size_each = SIZES[np.argmin(each, axis=1)]
    share = tss / tss.sum()
    by_size, by_jump = total.min(axis=1), total.min(axis=0)
    weight = np.exp(-0.5 * s * m / v.turn * np.log(by_size / best))
    fitted = stems.reshape(m, s, len(SIZES), len(JUMPS), len(STARTS))[:, :, i, j]
    found = {
        "play_r2": 1.0 - best,
        "linear_r2": 1.0 - float(linear.sum()),
        "play_ratio": float(linear.sum()) / best,
        "play_ratio_min": float(np.min(linear / table[:, i, j])),
        "play_ratio_max": float(np.max(linear / table[:, i, j])),
        "play_r2_min": float(np.min(1.0 - table[:, i, j] / share)),
        "play_wins": float(np.mean(table[:, i, j] < linear)),
        "play_size": float(SIZES[i]),
        "play_size_mean": float(weight @ SIZES / weight.sum()),
        "play_size_scatter": float(np.std(np.log(size_each))),
        "play_size_spread": float(
            np.sqrt(max(weight @ SIZES**2 / weight.sum() - (weight @ SIZES / weight.sum()) ** 2, 0))
        ),
        "play_jump": float(JUMPS[j]),
        "play_jump_gain": float(by_jump[0] / by_jump[1:].min()),
        "play_jump_full": float(by_jump[1] / by_jump[2]),
        "play_loss_small": float(by_size[0] / best),
        "play_loss_large": float(by_size[-1] / best),
        "play_gain": 0.5 * (s * m / v.turn) * math.log(float(linear.sum()) / best),
        "linear_lag": float(np.mean(LAG_OF[lag])),
        "linear_delay": float(np.mean(DELAY_OF[lag])),
    }
    least = min(best, float(linear.sum()))
    fall = 0.5 * (s * m / v.turn) * np.log(by_size / least)
    for margin in HIDDEN:  # the sizes that fit about as well as anything: a stick of those would not show
        alike = np.flatnonzero(fall < margin)
        found[f"play_hidden_{margin}"] = float(SIZES[alike[-1]]) if len(alike) else 0.0
    lagged = which[:, 1:].reshape(s, len(SIZES), len(JUMPS), len(STARTS))[:, i, j, 0]
    found["play_lag"] = float(np.mean(LAG_OF[lagged]))
    found["play_delay"] = float(np.mean(DELAY_OF[lagged]))
    found["play_integrates"] = float(np.mean(lagged >= INTEGRATOR))
    found["linear_integrates"] = float(np.mean(lag >= INTEGRATOR))
    stuck = np.mean(np.abs(np.diff(fitted, axis=0)) < 1e-9)
    found["play_stuck"] = float(stuck)
    found["play_stem_moves"] = float(np.mean(np.ptp(fitted, axis=0)) / travel)
    return found


BANK = [(lag, order, delay) for lag in LAGS for order in ((1, 2) if lag else (1,)) for delay in DELAYS]
INTEGRATOR = len(BANK)  # from here on the responses integrate
LAG_OF = np.array([lag * order for lag, order, _ in BANK] + [4.0] * len(DELAYS))
DELAY_OF = np.array([delay for _, _, delay in BANK] + list(DELAYS))


def responses(
    x: Lanes, y: Lanes, turn: float, settle: int | None = None
) -> tuple[Values, npt.NDArray[np.intp], Values]:
    """Least loss of each lane x (m, s, c) for y (s, m), the number of its response, and the total squares of y.

    Shapes (s, c), (s, c), (s,).  The first ``settle`` points, by default a turn, do not count; dead times shift the
    lanes.
    """
    from stickslip.detect.judge.features.response_kernels import ONCE, PLAIN, SUMMED, TWICE, tried

    m, s, c = x.shape
    settle = min(round(turn), m // 4) if settle is None else settle
    load = np.stack([np.ones(m - settle), np.linspace(-1.0, 1.0, m - settle)])  # an offset and a drift tell nothing
    load = (load / np.linalg.norm(load, axis=1, keepdims=True)).astype(np.float32)
    target = y.T[settle:]
    target = np.ascontiguousarray(target - load.T @ (load @ target))
    tss = np.maximum(np.sum(target**2, axis=0, dtype=np.float64), 1e-12)
    centred = np.ascontiguousarray(x - x[:1])
    mean, rows = centred.mean(axis=0), np.ascontiguousarray(load.T)
    shifts = np.array([min(round(delay * turn), settle) for delay in DELAYS])
    gain, which = np.zeros((s, c)), np.zeros((s, c), dtype=np.intp)
    filters = [(PLAIN, 0.0)]
    for lag in LAGS[1:]:
        a = math.exp(-1.0 / max(lag * turn, 0.05))
        filters += [(ONCE, a), (TWICE, a)]
    for k, (kind, a) in enumerate([*filters, (SUMMED, 0.0)]):
        tried(centred, mean, target, rows, kind, np.float32(a), shifts, k * len(DELAYS), gain, which)
    return np.maximum(tss[:, None] - gain, 1e-4 * tss[:, None]), which, tss
