"""The Jacobian of a component by forward differences that evaluate only what a state can reach.

A perturbed state changes the outputs of its own block and of the blocks fed by it at once, and the rates of the
blocks that read any of these; their programs stand in the block rows, so the sparsity is that of the diagram.
"""

from stickslip.engine.layout import (
    J_BACK,
    J_DER,
    J_OUT,
    J_ROWS,
    JACOBIANS,
    N_BLOCKS,
    N_SIGNALS,
    N_STATES,
    NX,
    O_DFDT,
    O_F,
    O_JAC,
    O_K,
    O_RATE,
    O_S,
    O_X,
    O_Y0,
    P_MOVING,
    T_LEFT,
    TIMED,
    H,
    R,
    X,
)
from stickslip.engine.sweep import play, rates
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy")
def jacobian(I, W, t, h):  # type: ignore[no-untyped-def]
    """Fill df/dy and df/dt at the start of a step; the rates there stand at ``W[O_K]``."""
    n = I[N_STATES]
    x, f, k, y0, dfdt = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_DFDT]
    I[JACOBIANS] += 1
    for i in range(n):
        W[x + i] = W[y0 + i]
        W[dfdt + i] = 0.0
    shift = (t + 1e-3 * h) - t
    if I[TIMED] and shift > 0.0 and t + 2.0 * shift <= W[T_LEFT]:
        for m in range(1, 3):  # three points: with two the method falls back to order 2
            rates(I, W, t + m * shift)
            weight = 2.0 if m == 1 else -0.5
            for i in range(n):
                W[dfdt + i] += weight * (W[f + i] - W[k + i]) / shift
    play(I, W, t, P_MOVING)
    s, kept = I[O_S], I[O_RATE]
    for i in range(I[N_SIGNALS]):
        W[kept + i] = W[s + i]
    at = I[O_JAC]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        for j in range(I[row + X], I[row + X] + I[row + NX]):
            at = _column(I, W, row, j, t, at)


@njit(cache=True, error_model="numpy")
def _column(I, W, row, j, t, at):  # type: ignore[no-untyped-def]
    """Perturb state ``j`` of the block at ``row`` and write its column to ``W[at]``; return where the next one goes."""
    x, f, k, s, kept = I[O_X], I[O_F], I[O_K], I[O_S], I[O_RATE]
    start = W[x + j]
    W[x + j] = start + 1.5e-8 * max(abs(start), 1e-3)
    inverse = 1.0 / (W[x + j] - start)
    play(I, W, t, row + J_OUT)
    play(I, W, t, row + J_DER)
    W[x + j] = start
    changed, count = I[row + J_ROWS], I[row + J_ROWS + 1]
    for m in range(count):
        i = I[changed + m]
        W[at + m] = (W[f + i] - W[k + i]) * inverse
    back = I[row + J_BACK]
    for m in range(I[row + J_BACK + 1]):
        i = I[back + m]
        W[s + i] = W[kept + i]
    return at + count
