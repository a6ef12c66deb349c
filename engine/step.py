"""One accepted step by the method in use, and its dense output."""

import numpy as np
from stickslip.engine.explicit import STIFF_RATIO, explicit_dense, explicit_step
from stickslip.engine.floats import copy
from stickslip.engine.high_order import HIGH_STIFF_RATIO, high_order_dense, high_order_step
from stickslip.engine.jacobian import jacobian
from stickslip.engine.layout import (
    DENSE_TERMS,
    EXPLICIT,
    JAC_VALID,
    METHOD,
    METHOD_WISH,
    N_STATES,
    O_F,
    O_Y1,
    OTHERWISE,
    REJECTED,
    STEP,
    STEPS,
    T_STOP,
    T,
)
from stickslip.engine.pace import after_refusal, after_step, proposed
from stickslip.engine.rosenbrock import rosenbrock_dense, rosenbrock_step
from stickslip.engine.series import series_step
from stickslip.engine.sweep import clock
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")
def attempt(I, W, t, h):  # type: ignore[no-untyped-def]
    """Try one step; return its error, 1 / order of the error, and whether stability limits it."""
    if I[METHOD] == 3:
        error, terms, limited = series_step(I, W, t, h)
        if error >= 0.0:
            return error, 1.0 / terms, limited
        I[METHOD] = I[OTHERWISE]
    if I[METHOD] == 0:
        error, ratio = explicit_step(I, W, t, h)
        return error, 0.2, ratio > STIFF_RATIO
    if I[METHOD] == 2:
        error, ratio = high_order_step(I, W, t, h)
        return error, 0.125, ratio > HIGH_STIFF_RATIO
    if not I[JAC_VALID]:
        jacobian(I, W, t, h)
        I[JAC_VALID] = 1
    return rosenbrock_step(I, W, t, h), 0.2, False


@njit(cache=True, error_model="numpy")
def step(I, W):  # type: ignore[no-untyped-def]
    """Try until a step is accepted; return its length and whether stability limits it.

    The length is 0 if steps became shorter than the clock resolves, -1 if nothing was finite there.  States and rates
    at the end stand at ``W[O_Y1]``.
    """
    t = W[T]
    left = W[T_STOP] - t
    refused = False
    if I[METHOD] == I[OTHERWISE] and I[METHOD_WISH] == 0:
        I[METHOD] = I[EXPLICIT]  # the step before may have been none for it
    while True:
        h = proposed(W, left)
        error, power, limited = attempt(I, W, t, h)
        if error <= 1.0:
            break
        refused = True
        I[REJECTED] += 1
        after_refusal(W, h, error, power)
        if W[STEP] < clock(W):
            return (0.0 if np.isfinite(error) else -1.0), limited
    I[STEPS] += 1
    after_step(I, W, h, left, error, power, refused)
    n = I[N_STATES]
    copy(W, I[O_F], I[O_Y1] + n, n)  # kept over dense output and event searches
    return h, limited


@njit(cache=True, error_model="numpy", inner=True)
def prepare_dense(I, W, t, h):  # type: ignore[no-untyped-def]
    """Prepare the dense output of the step just accepted."""
    if I[METHOD] == 3:
        return  # the terms of the series are its dense output
    I[DENSE_TERMS] = 8 if I[METHOD] == 2 else 5
    if I[METHOD] == 0:
        explicit_dense(I, W, h)
    elif I[METHOD] == 2:
        high_order_dense(I, W, t, h)
    else:
        rosenbrock_dense(I, W)
