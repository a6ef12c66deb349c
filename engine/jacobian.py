"""The Jacobian of a component by forward differences that evaluate only what a state can reach.

A perturbed state changes the outputs of its own block and of the blocks fed by it at once, and the rates of the
blocks that read any of these; the lists stand in the block rows, so the sparsity is that of the diagram.
"""

from numba import njit

from engine.call import call
from engine.layout import (
    A_DER,
    A_OUT,
    J_DER,
    J_OUT,
    JACOBIANS,
    N_BLOCKS,
    N_J_DER,
    N_J_OUT,
    N_SIGNALS,
    N_STATES,
    NX,
    NY,
    O_DFDT,
    O_F,
    O_JAC,
    O_K,
    O_RATE,
    O_S,
    O_X,
    O_Y0,
    T_LEFT,
    D,
    H,
    P,
    R,
    U,
    X,
    Y,
)
from engine.sweep import gather, rates, signals


@njit(cache=True, error_model="numpy")
def jacobian(I, W, t, h):  # type: ignore[no-untyped-def]
    """Fill df/dy (row major) and df/dt at the start of a step; the rates there stand at ``W[O_K]``."""
    n = I[N_STATES]
    x, f, k, y0, dfdt = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_DFDT]
    I[JACOBIANS] += 1
    for i in range(n):
        W[x + i] = W[y0 + i]
        W[dfdt + i] = 0.0
    shift = (t + 1e-3 * h) - t
    if shift > 0.0 and t + 2.0 * shift <= W[T_LEFT]:  # three points: with two the method falls back to order 2
        for m in range(1, 3):
            rates(I, W, t + m * shift)
            weight = 2.0 if m == 1 else -0.5
            for i in range(n):
                W[dfdt + i] += weight * (W[f + i] - W[k + i]) / shift
    signals(I, W, t)
    s, kept = I[O_S], I[O_RATE]
    for i in range(I[N_SIGNALS]):
        W[kept + i] = W[s + i]
    if t > W[T_LEFT]:
        t = W[T_LEFT]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        for j in range(I[row + X], I[row + X] + I[row + NX]):
            _column(I, W, row, j, t)


@njit(cache=True, error_model="numpy")
def _column(I, W, row, j, t):  # type: ignore[no-untyped-def]
    """Perturb state ``j`` of the block at ``row`` and fill its column, leaving states and signals as they were."""
    n = I[N_STATES]
    x, f, k, s, kept, jac = I[O_X], I[O_F], I[O_K], I[O_S], I[O_RATE], I[O_JAC]
    start = W[x + j]
    W[x + j] = start + 1.5e-8 * max(abs(start), 1e-3)
    shift = W[x + j] - start
    for m in range(I[row + N_J_OUT]):
        other = I[I[row + J_OUT] + m]
        gather(I, W, other)
        u, d, p = I[other + U], I[other + D], I[other + P]
        call(I[other + A_OUT], t, W, x + I[other + X], d, u, p, s + I[other + Y])
    for m in range(I[row + N_J_DER]):
        other = I[I[row + J_DER] + m]
        gather(I, W, other)
        u, d, p = I[other + U], I[other + D], I[other + P]
        call(I[other + A_DER], t, W, x + I[other + X], d, u, p, f + I[other + X])
        for i in range(I[other + X], I[other + X] + I[other + NX]):
            W[jac + i * n + j] = (W[f + i] - W[k + i]) / shift
    W[x + j] = start
    for m in range(I[row + N_J_OUT]):
        other = I[I[row + J_OUT] + m]
        for i in range(I[other + Y], I[other + Y] + I[other + NY]):
            W[s + i] = W[kept + i]
