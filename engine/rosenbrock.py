"""Stiff steps: the L-stable Rosenbrock method Rodas5P of order 5 with dense output of order 4.

One Jacobian by finite differences and one factorisation per step, eight solves, no iteration.  Coefficients:
Steinebach 2023, "Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia
Differential Equations package", BIT 63:27.  Like RODASP, and unlike RODAS4, it keeps its order where a stiff part
follows a smooth input; the orders are measured in ``tests/engine/test_order.py``.
"""

import numpy as np
from stickslip.engine.floats import finite
from stickslip.engine.layout import (
    ATOL,
    HAS_DELAYS,
    N_CHECKED,
    N_EVENTS,
    N_STATES,
    NEXT_ROW,
    O_CONT,
    O_DFDT,
    O_F,
    O_K,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    RTOL,
    TIMED,
)
from stickslip.engine.linear import factorise, solve
from stickslip.engine.sweep import rates
from stickslip.logs.compiled import njit

_GAMMA = 0.21193756319429014
_ALPHA = np.array([0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0])
_D = np.array([_GAMMA, -2.0 * _GAMMA, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0])
_LAST = (-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946)
_A = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [3.0, 0, 0, 0, 0, 0, 0],
        [2.849394379747939, 0.45842242204463923, 0, 0, 0, 0, 0],
        [-6.954028509809101, 2.489845061869568, -10.358996098473584, 0, 0, 0, 0],
        [2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641, 0, 0, 0],
        [*_LAST, 0, 0],
        [*_LAST, 1.0, 0],
        [*_LAST, 1.0, 1.0],
    ]
)
_C = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [-14.155112264123755, 0, 0, 0, 0, 0, 0],
        [-17.97296035885952, -2.859693295451294, 0, 0, 0, 0, 0],
        [147.12150275711716, -1.41221402718213, 71.68940251302358, 0, 0, 0, 0],
        [165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306, 0, 0, 0],
        [24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471, 0, 0],
        [
            30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783, -19.097331116725623,
            -28.087943162872662, 0,
        ],
        [
            37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047, -40.06618937091002,
            -54.66780262877968, -9.48861652309627,
        ],
    ]
)  # fmt: skip
_DENSE = np.array(
    [
        [
            25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204, 0.524948541321073,
            1.1241088310450404, 0.4272876194431874, -0.17202221070155493,
        ],
        [
            -9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796, 20.176138334709044,
            15.98066361424651, -6.789040303419874, -6.710236069923372,
        ],
        [
            11.419903575922262, 2.8879646145136994, 72.92137995996029, 80.12511834622643, -52.072871366152654,
            -59.78993625266729, -0.15582684282751913, 4.883087185713722,
        ],
    ]
)  # fmt: skip
_STAGES = 8
BETWEEN = 1.0  # error norm of the dense output that a step may have


@njit(cache=True, error_model="numpy", inner=True)
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
    for stage in range(_STAGES):
        at = k + (stage + 1) * n
        if stage > 0:
            for i in range(n):
                W[x + i] = W[y0 + i]
            for j in range(stage):
                weight, source = _A[stage, j], k + (j + 1) * n
                for i in range(n):
                    W[x + i] += weight * W[source + i]
            rates(I, W, t + _ALPHA[stage] * h)
        base = k if stage == 0 else f
        for i in range(n):
            W[at + i] = W[base + i]
        for j in range(stage):
            weight, source = _C[stage, j] / h, k + (j + 1) * n
            for i in range(n):
                W[at + i] += weight * W[source + i]
        if I[TIMED]:
            weight = h * _D[stage]
            for i in range(n):
                W[at + i] += weight * W[dfdt + i]
        solve(I, W, at)
    worst = 0.0
    last = k + _STAGES * n
    for i in range(n):
        W[y1 + i] = W[x + i] + W[last + i]
        scale = W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i]))
        worst += (W[last + i] / scale) ** 2
    worst = np.sqrt(worst / max(n, 1))  # without a state no step is wrong
    if not finite(W, y1, n):
        return np.inf
    if worst <= 1.0 and (I[N_EVENTS] > 0 or I[HAS_DELAYS] or W[NEXT_ROW] < t + h):
        worst = max(worst, _error_between(I, W, t, h) / BETWEEN)
    for i in range(n):
        W[x + i] = W[y1 + i]
    rates(I, W, t + h)
    if not finite(W, f, n) or not finite(W, I[O_S], I[N_CHECKED]):
        return np.inf
    return worst


@njit(cache=True, error_model="numpy", inner=True)
def _error_between(I, W, t, h):  # type: ignore[no-untyped-def]
    """Return the error norm of the dense output in the middle of a step.

    A step may end right and have a wrong curve before its end: what dies away within it is passed over, not followed.
    The curve misses the rates there by d, and the states by about e, where e / (gamma h) - J e = d.
    """
    n = I[N_STATES]
    x, f, y0, y1, c = I[O_X], I[O_F], I[O_Y0], I[O_Y1], I[O_CONT]
    rosenbrock_dense(I, W)
    for i in range(n):
        W[x + i] = W[c + i] + W[c + n + i] / 2 + W[c + 2 * n + i] / 4 + W[c + 3 * n + i] / 8 + W[c + 4 * n + i] / 16
    rates(I, W, t + 0.5 * h)
    for i in range(n):
        W[f + i] -= (W[c + n + i] + W[c + 3 * n + i] / 4) / h
    solve(I, W, f)
    worst = 0.0
    for i in range(n):
        scale = W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i]))
        worst += (W[f + i] / scale) ** 2
    return np.sqrt(worst / max(n, 1))


@njit(cache=True, error_model="numpy", inner=True)
def rosenbrock_dense(I, W):  # type: ignore[no-untyped-def]
    """Prepare the dense output of the step just accepted, in the form of ``dense.interpolate``."""
    n = I[N_STATES]
    k, y0, y1, c = I[O_K], I[O_Y0], I[O_Y1], I[O_CONT]
    for i in range(n):
        W[c + i] = W[y0 + i]
        W[c + n + i] = W[y1 + i] - W[y0 + i]
        first, second, third = 0.0, 0.0, 0.0
        for j in range(_STAGES):
            stage = W[k + (j + 1) * n + i]
            first += _DENSE[0, j] * stage
            second += _DENSE[1, j] * stage
            third += _DENSE[2, j] * stage
        W[c + 2 * n + i] = first
        W[c + 3 * n + i] = second + third
        W[c + 4 * n + i] = -third
