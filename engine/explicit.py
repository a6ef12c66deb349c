"""Explicit steps: the Dormand-Prince 5(4) pair with its fourth-order dense output.

Used wherever the model is not stiff.  Coefficients: Dormand & Prince 1980, dense output after Hairer, Norsett &
Wanner, Solving ODEs I, section II.6; the order is measured in ``tests/engine/test_order.py``.
"""

import numpy as np
from stickslip.engine.floats import finite
from stickslip.engine.layout import (
    ATOL,
    N_CHECKED,
    N_STATES,
    O_CONT,
    O_F,
    O_K,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    RTOL,
)
from stickslip.engine.sweep import rates
from stickslip.logs.compiled import njit

STIFF_RATIO = 3.25  # h |df/dy| beyond this is the stability limit of the pair at work
_C = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_A = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_E = np.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
_DENSE = np.array(
    [
        -12715105075 / 11282082432,
        0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        69997945 / 29380423,
    ]
)


@njit(cache=True, error_model="numpy", inner=True)
def explicit_step(I, W, t, h):  # type: ignore[no-untyped-def]
    """Try one step from ``W[O_Y0]`` (first stage at ``W[O_K]``); return (error norm, stiffness ratio)."""
    n = I[N_STATES]
    x, f, k, y0, y1 = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_Y1]
    slope = 0.0
    change = 0.0
    for stage in range(1, 7):
        for i in range(n):
            total = 0.0
            for j in range(stage):
                total += _A[stage, j] * W[k + j * n + i]
            value = W[y0 + i] + h * total
            if stage == 6:
                W[y1 + i] = value
                change = max(change, abs(value - W[x + i]) / (W[ATOL] + W[RTOL] * abs(value)))
            W[x + i] = value
        rates(I, W, t + _C[stage] * h)
        for i in range(n):
            if stage == 6:
                scale = W[ATOL] + W[RTOL] * abs(W[y1 + i])
                slope = max(slope, abs(W[f + i] - W[k + 5 * n + i]) / scale)
            W[k + stage * n + i] = W[f + i]
    worst = 0.0
    for i in range(n):
        err = 0.0
        for j in range(7):
            err += _E[j] * W[k + j * n + i]
        scale = W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i]))
        worst = max(worst, abs(h * err) / scale)
    if not finite(W, f, n) or not finite(W, I[O_S], I[N_CHECKED]):
        worst = np.inf
    return worst, h * slope / max(change, 1e-300)


@njit(cache=True, error_model="numpy", inner=True)
def explicit_dense(I, W, h):  # type: ignore[no-untyped-def]
    """Prepare the dense output of the step just accepted."""
    n = I[N_STATES]
    k, y0, y1, c = I[O_K], I[O_Y0], I[O_Y1], I[O_CONT]
    for i in range(n):
        rise = W[y1 + i] - W[y0 + i]
        bend = h * W[k + i] - rise
        last = 0.0
        for j in range(7):
            last += _DENSE[j] * W[k + j * n + i]
        W[c + i] = W[y0 + i]
        W[c + n + i] = rise
        W[c + 2 * n + i] = bend
        W[c + 3 * n + i] = rise - h * W[k + 6 * n + i] - bend
        W[c + 4 * n + i] = h * last
