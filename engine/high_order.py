"""Explicit steps of high order: the Dormand-Prince 8(5,3) method, for smooth stretches between events.

Twelve stages carry it over steps many times longer than the 5(4) pair takes at the same accuracy; three more
serve the seventh-order dense output.  Coefficients in ``stickslip.engine.dop853``; the order is measured in
``tests/engine/test_order.py``.
"""

import numpy as np
from stickslip.engine.dop853 import (
    A_STAGE,
    A_START,
    A_WEIGHT,
    DENSE_STAGE,
    DENSE_START,
    DENSE_WEIGHT,
    E_STAGE,
    E_START,
    E_WEIGHT,
    C,
)
from stickslip.engine.floats import finite
from stickslip.engine.layout import ATOL, N_CHECKED, N_STATES, O_CONT, O_F, O_K, O_S, O_X, O_Y0, O_Y1, RTOL
from stickslip.engine.sweep import rates
from stickslip.logs.compiled import njit

HIGH_STIFF_RATIO = 6.1  # h |df/dy| beyond this is the stability limit of the method at work


@njit(cache=True, error_model="numpy", inner=True)
def high_order_step(I, W, t, h):  # type: ignore[no-untyped-def]
    """Try one step from ``W[O_Y0]`` (first stage at ``W[O_K]``); return (error norm, stiffness ratio)."""
    n = I[N_STATES]
    x, f, k, y0, y1 = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_Y1]
    change = 0.0
    for stage in range(1, 13):
        for i in range(n):
            total = 0.0
            for m in range(A_START[stage], A_START[stage + 1]):
                total += A_WEIGHT[m] * W[k + A_STAGE[m] * n + i]
            value = W[y0 + i] + h * total
            if stage == 12:
                W[y1 + i] = value
                change = max(change, abs(value - W[x + i]) / (W[ATOL] + W[RTOL] * abs(value)))
            W[x + i] = value
        rates(I, W, t + C[stage] * h)
        for i in range(n):
            W[k + stage * n + i] = W[f + i]
    worst, slope = 0.0, 0.0
    for i in range(n):
        scale = W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i]))
        slope = max(slope, abs(W[k + 12 * n + i] - W[k + 11 * n + i]) / scale)
        fifth, third = 0.0, 0.0
        for m in range(E_START[0], E_START[1]):
            fifth += E_WEIGHT[m] * W[k + E_STAGE[m] * n + i]
        for m in range(E_START[1], E_START[2]):
            third += E_WEIGHT[m] * W[k + E_STAGE[m] * n + i]
        if fifth != 0.0:
            ratio = third / fifth  # of what may be too large to be squared
            worst = max(worst, abs(h * fifth) / np.sqrt(1.0 + 0.01 * ratio * ratio) / scale)
    if not finite(W, f, n) or not finite(W, I[O_S], I[N_CHECKED]):
        worst = np.inf
    return worst, h * slope / max(change, 1e-300)


@njit(cache=True, error_model="numpy", inner=True)
def high_order_dense(I, W, t, h):  # type: ignore[no-untyped-def]
    """Prepare the dense output of the step just accepted, at the cost of three more rates."""
    n = I[N_STATES]
    x, f, k, y0, y1, c = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_Y1], I[O_CONT]
    for stage in range(13, 16):
        for i in range(n):
            total = 0.0
            for m in range(A_START[stage], A_START[stage + 1]):
                total += A_WEIGHT[m] * W[k + A_STAGE[m] * n + i]
            W[x + i] = W[y0 + i] + h * total
        rates(I, W, t + C[stage] * h)
        for i in range(n):
            W[k + stage * n + i] = W[f + i]
    for i in range(n):
        rise = W[y1 + i] - W[y0 + i]
        W[c + i] = W[y0 + i]
        W[c + n + i] = rise
        W[c + 2 * n + i] = h * W[k + i] - rise
        W[c + 3 * n + i] = 2.0 * rise - h * (W[k + 12 * n + i] + W[k + i])
        for q in range(4):
            total = 0.0
            for m in range(DENSE_START[q], DENSE_START[q + 1]):
                total += DENSE_WEIGHT[m] * W[k + DENSE_STAGE[m] * n + i]
            W[c + (4 + q) * n + i] = h * total
