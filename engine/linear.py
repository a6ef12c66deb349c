"""Linear systems of a stiff step: ``diagonal - J`` factorised and solved along a plan made with the diagram.

Process models couple each state to few others; ``stickslip.engine.elimination`` orders them so that hardly any entry is
added. Rows are not exchanged: with a shorter step the diagonal dominates, and a step spoilt by a poor factorisation is
rejected for its error like any other.
"""

from stickslip.engine.layout import (
    L_BACKWARD,
    L_DIAGONAL,
    L_FACTOR,
    L_FORWARD,
    L_PLACE,
    N_FACTORS,
    N_JAC,
    N_STATES,
    O_JAC,
    O_LU,
)
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy", inner=True)
def factorise(I, W, diagonal):  # type: ignore[no-untyped-def]
    """Factorise ``diagonal - J``; return whether that went well.  The factors hold inverse diagonals."""
    n, lu, jac = I[N_STATES], I[O_LU], I[O_JAC]
    for k in range(I[N_FACTORS]):
        W[lu + k] = 0.0
    places, diagonals = I[L_PLACE], I[L_DIAGONAL]
    for k in range(I[N_JAC]):
        W[lu + I[places + k]] = -W[jac + k]
    for i in range(n):
        W[lu + I[diagonals + i]] += diagonal
    at = I[L_FACTOR]
    for _ in range(n):
        lefts = I[at]
        at += 1
        for _ in range(lefts):
            place, count = lu + I[at], I[at + 2]
            share = W[place] * W[lu + I[at + 1]]
            W[place] = share
            at += 3
            for _ in range(count):
                W[lu + I[at]] -= share * W[lu + I[at + 1]]
                at += 2
        pivot = W[lu + I[at]]
        if not abs(pivot) > 0.0:
            return False
        W[lu + I[at]] = 1.0 / pivot
        at += 1
    return True


@njit(cache=True, error_model="numpy")
def solve(I, W, b):  # type: ignore[no-untyped-def]
    """Solve in place for the right-hand side at ``W[b]``."""
    n, lu = I[N_STATES], I[O_LU]
    at = I[L_FORWARD]
    for _ in range(n):
        i, place, count = I[at], lu + I[at + 1], I[at + 2]
        at += 3
        total = W[b + i]
        for m in range(count):
            total -= W[place + m] * W[b + I[at + m]]
        W[b + i] = total
        at += count
    at = I[L_BACKWARD]
    for _ in range(n):
        i, place, count = I[at], lu + I[at + 1], I[at + 2]
        at += 3
        total = W[b + i]
        for m in range(count):
            total -= W[place + 1 + m] * W[b + I[at + m]]
        W[b + i] = total * W[place]
        at += count
