"""Dense output: one nested polynomial in the fraction of the step, for all three methods."""

from numba import njit

from engine.layout import DENSE_TERMS, N_STATES, O_CONT, O_X


@njit(cache=True, error_model="numpy")
def interpolate(I, W, s):  # type: ignore[no-untyped-def]
    """Write the state at the fraction ``s`` of the last step to ``W[O_X]``.

    ``y = c0 + s (c1 + (1 - s) (c2 + s (c3 + (1 - s) (c4 + ...))))``, with as many terms as the method has.
    """
    n, terms = I[N_STATES], I[DENSE_TERMS]
    x, c = I[O_X], I[O_CONT]
    r = 1.0 - s
    for i in range(n):
        total = 0.0
        for m in range(terms - 1, 0, -1):
            total = (total + W[c + m * n + i]) * (s if m % 2 == 1 else r)
        W[x + i] = W[c + i] + total
