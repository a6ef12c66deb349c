"""Dense output: one nested polynomial in the fraction of the step, whatever the method."""

from stickslip.engine.layout import CHUNK, DENSE_TERMS, N_STATES, O_CONT, O_CX, O_X
from stickslip.engine.series import half_again, make_terms
from stickslip.logs.compiled import njit

TOGETHER = 8  # rows


@njit(cache=True, error_model="numpy", inner=True)
def interpolate(I, W, s):  # type: ignore[no-untyped-def]
    """Write the state at the fraction ``s`` of the last step to ``W[O_X]``.

    ``y = c0 + s (c1 + (1 - s) (c2 + s (c3 + (1 - s) (c4 + ...))))``, with as many terms as the method has; a series
    has ``y = c0 + s (c1 + s (c2 + ...))``.
    """
    n, terms = I[N_STATES], I[DENSE_TERMS]
    x, c = I[O_X], I[O_CONT]
    first = 0
    if terms == 0:
        if s == 0.5:
            half_again(I, W)
            return
        make_terms(I, W)
        terms = I[DENSE_TERMS]
    if terms < 0:
        while first + 4 <= n:  # four states at a time: each waits for its own last product only
            a0, a1, a2, a3 = 0.0, 0.0, 0.0, 0.0
            at = c + first + (-terms - 1) * n
            for _ in range(-terms - 1):
                a0, a1, a2, a3 = (a0 + W[at]) * s, (a1 + W[at + 1]) * s, (a2 + W[at + 2]) * s, (a3 + W[at + 3]) * s
                at -= n
            W[x + first], W[x + first + 1] = W[at] + a0, W[at + 1] + a1
            W[x + first + 2], W[x + first + 3] = W[at + 2] + a2, W[at + 3] + a3
            first += 4
        for i in range(first, n):
            total = 0.0
            for m in range(-terms - 1, 0, -1):
                total = (total + W[c + m * n + i]) * s
            W[x + i] = W[c + i] + total
        return
    r = 1.0 - s
    for i in range(n):
        total = 0.0
        for m in range(terms - 1, 0, -1):
            total = (total + W[c + m * n + i]) * (s if m % 2 == 1 else r)
        W[x + i] = W[c + i] + total


@njit(cache=True, error_model="numpy", inner=True)
def interpolate_rows(I, W, times, first, count, t, h):  # type: ignore[no-untyped-def]
    """Write the states at ``count`` times from ``times[first]`` on, inside the step, to ``W[O_CX]``, row by row.

    They are those of ``interpolate``; eight rows at a time go through the polynomial side by side.
    """
    if I[DENSE_TERMS] == 0:
        make_terms(I, W)
    n, terms, cx, c = I[N_STATES], I[DENSE_TERMS], I[O_CX], I[O_CONT]
    share = cx + CHUNK * n
    for r in range(count):
        W[share + r] = (times[first + r] - t) / h
    last = count + (-count) % TOGETHER
    for r in range(count, last):
        W[share + r] = 0.0
    for eight in range(0, last, TOGETHER):
        at = share + eight
        s0, s1, s2, s3 = W[at], W[at + 1], W[at + 2], W[at + 3]
        s4, s5, s6, s7 = W[at + 4], W[at + 5], W[at + 6], W[at + 7]
        for i in range(n):
            a0, a1, a2, a3, a4, a5, a6, a7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for m in range(abs(terms) - 1, 0, -1):
                term = W[c + m * n + i]
                a0, a1, a2, a3 = a0 + term, a1 + term, a2 + term, a3 + term
                a4, a5, a6, a7 = a4 + term, a5 + term, a6 + term, a7 + term
                if terms < 0 or m % 2 == 1:
                    a0, a1, a2, a3 = a0 * s0, a1 * s1, a2 * s2, a3 * s3
                    a4, a5, a6, a7 = a4 * s4, a5 * s5, a6 * s6, a7 * s7
                else:
                    a0, a1, a2, a3 = a0 * (1.0 - s0), a1 * (1.0 - s1), a2 * (1.0 - s2), a3 * (1.0 - s3)
                    a4, a5, a6, a7 = a4 * (1.0 - s4), a5 * (1.0 - s5), a6 * (1.0 - s6), a7 * (1.0 - s7)
            base, to = W[c + i], cx + eight * n + i
            W[to], W[to + n], W[to + 2 * n], W[to + 3 * n] = base + a0, base + a1, base + a2, base + a3
            W[to + 4 * n], W[to + 5 * n], W[to + 6 * n], W[to + 7 * n] = base + a4, base + a5, base + a6, base + a7
