"""Stiff steps: the L-stable Rosenbrock method RODASP with third-order dense output.

One Jacobian by finite differences and one LU factorisation per step, six solves, no iteration.  Coefficients:
Steinebach 1995 (as in Hairer & Wanner, Solving ODEs II, section VI.4), chosen over RODAS4 because it keeps its order
where a stiff part follows a smooth input: on the Prothero-Robinson problem with -1000/s its error is a hundred
times smaller.  The order is measured in ``tests/engine/test_order.py``.
"""

import numpy as np
from numba import njit

from engine.layout import (
    ATOL,
    N_CHECKED,
    N_STATES,
    O_CONT,
    O_DFDT,
    O_F,
    O_K,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    RTOL,
)
from engine.linear import factorise, solve
from engine.sweep import finite, rates

_GAMMA = 0.25
_ALPHA = np.array([0.0, 0.75, 0.21, 0.63, 1.0, 1.0])
_D = np.array([0.25, -0.5, -0.023504, -0.0362, 0.0, 0.0])
_A = np.array(
    [
        [0, 0, 0, 0, 0],
        [3.0, 0, 0, 0, 0],
        [1.831036793486759, 0.4955183967433795, 0, 0, 0],
        [2.304376582692669, -0.05249275245743001, -1.176798761832782, 0, 0],
        [-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 0],
        [-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 1.0],
    ]
)
_C = np.array(
    [
        [0, 0, 0, 0, 0],
        [-12.0, 0, 0, 0, 0],
        [-8.791795173947035, -2.207865586973518, 0, 0, 0],
        [10.81793056857153, 6.780270611428266, 19.53485944642410, 0, 0],
        [34.19095006749676, 15.49671153725963, 54.74760875964130, 14.16005392148534, 0],
        [34.62605830930532, 15.30084976114473, 56.99955578662667, 18.40807009793095, -5.714285714285717],
    ]
)
_DENSE = np.array(
    [
        [25.09876703708589, 11.62013104361867, 28.49148307714626, -5.664021568594133, 0],
        [1.638054557396973, -0.7373619806678748, 8.477918219238990, 15.99253148779520, -1.882352941176471],
    ]
)


@njit(cache=True, error_model="numpy")
def rosenbrock_step(I, W, t, h):  # type: ignore[no-untyped-def]
    """Try one step from ``W[O_Y0]``; the rates there stand at ``W[O_K]``; return the error norm.

    The norm is the root mean square over the states, as in LSODA and CVODE.

    Stages are kept behind the first slot of ``W[O_K]``, which still holds the rates at the start.
    """
    n = I[N_STATES]
    x, f, k, y0, y1 = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_Y1]
    dfdt = I[O_DFDT]
    if not factorise(I, W, 1.0 / (h * _GAMMA)):
        return np.inf
    for stage in range(6):
        at = k + (stage + 1) * n
        if stage > 0:
            for i in range(n):
                total = W[y0 + i]
                for j in range(stage):
                    total += _A[stage, j] * W[k + (j + 1) * n + i]
                W[x + i] = total
            rates(I, W, t + _ALPHA[stage] * h)
        for i in range(n):
            total = W[k + i] if stage == 0 else W[f + i]
            for j in range(stage):
                total += _C[stage, j] / h * W[k + (j + 1) * n + i]
            W[at + i] = total + h * _D[stage] * W[dfdt + i]
        solve(I, W, at)
    worst = 0.0
    last = k + 6 * n
    for i in range(n):
        W[y1 + i] = W[x + i] + W[last + i]
        scale = W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i]))
        worst += (W[last + i] / scale) ** 2
    if not finite(W, y1, n):
        return np.inf
    for i in range(n):
        W[x + i] = W[y1 + i]
    rates(I, W, t + h)
    if not finite(W, f, n) or not finite(W, I[O_S], I[N_CHECKED]):
        return np.inf
    return np.sqrt(worst / n)


@njit(cache=True, error_model="numpy")
def rosenbrock_dense(I, W):  # type: ignore[no-untyped-def]
    """Prepare the dense output of the step just accepted, in the form of ``dense.interpolate``."""
    n = I[N_STATES]
    k, y0, y1, c = I[O_K], I[O_Y0], I[O_Y1], I[O_CONT]
    for i in range(n):
        W[c + i] = W[y0 + i]
        W[c + n + i] = W[y1 + i] - W[y0 + i]
        for m in range(2):
            total = 0.0
            for j in range(5):
                total += _DENSE[m, j] * W[k + (j + 1) * n + i]
            W[c + (2 + m) * n + i] = total
