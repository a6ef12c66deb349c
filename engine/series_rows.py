"""Log rows inside a step of ``series``: where every signal is affine too, it has a series of its own.

Between two instants, while no mode changes, the signals of such a component are affine in states and time,

    y(t_0 + s h) = y_0 + C (x(s) - x_0) + d s h = y_0 + sum_m q_m s^m,      q_m = C p_m,  and d h beside q_1,

so a row costs one polynomial a signal in place of one a state and a sweep over all blocks.  C and d are differences of
the signals, kept as long as the modes stay.  As in ``series`` nothing is taken on trust: at the end of the step the
blocks say what their signals are, and where these differ, C and d are taken anew or the rows are computed block by
block.
"""

from stickslip.engine.dense import interpolate
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    ATOL,
    CHUNK,
    DENSE_TERMS,
    L_WIRES,
    MODEL,
    N_LOG,
    N_SIGNALS,
    N_STATES,
    N_TIMES,
    O_AFFINE,
    O_CONT,
    O_CS,
    O_CX,
    O_K,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    ROW,
    RTOL,
    T_STOP,
    TIMED,
)
from stickslip.engine.series import SHARE, TRUST, make_terms
from stickslip.engine.sweep import signals
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy", inner=True)
def series_rows(I, W, times, log, t, h, t_new, share):  # type: ignore[no-untyped-def]
    """Write the log rows strictly before ``t_new`` from the series of the signals; return whether these hold.

    The signals are left as they are at the ``share`` of the step up to which no event fires.
    """
    if I[DENSE_TERMS] == 0:
        make_terms(I, W)
    n, ns, terms = I[N_STATES], I[N_SIGNALS], -I[DENSE_TERMS] - 1
    copy(W, I[O_Y0], I[O_X], n)
    signals(I, W, t)
    start = I[O_CS]  # the signals at the start of the step, where chunks of rows would otherwise stand
    copy(W, I[O_S], start, ns)
    fresh = W[I[O_AFFINE]] != I[MODEL] + 1.0
    while True:
        if fresh:
            take_affine(I, W, t, h, start)
        if share < 1.0:
            interpolate(I, W, share)
        else:
            copy(W, I[O_Y1], I[O_X], n)
        signals(I, W, t + share * h)
        if holds(I, W, share * h, start):
            break
        if fresh:
            W[I[O_AFFINE]] = 0.0
            return False
        fresh = True
    first, fractions = I[ROW], I[O_CX]
    q = fractions + CHUNK  # the terms of one signal
    while True:
        count = 0
        while count < CHUNK and first + count < I[N_TIMES] and times[first + count] < t_new:
            W[fractions + count] = (times[first + count] - t) / h
            count += 1
        if count == 0:
            break
        for k in range(I[N_LOG]):
            i = I[I[L_WIRES] + k]
            moves = terms_of(I, W, i, terms, h, q)
            to = k * I[N_TIMES] + first
            for r in range(count):
                log[to + r] = 0.0
            for m in range(moves - 1, -1, -1):
                term = W[q + m]
                for r in range(count):
                    log[to + r] = (log[to + r] + term) * W[fractions + r]
            base = W[start + i]
            for r in range(count):
                log[to + r] += base
        first += count
    I[ROW] = first
    return True


@njit(cache=True, error_model="numpy", inner=True)
def terms_of(I, W, i, terms, h, q):  # type: ignore[no-untyped-def]
    """Write the terms of signal ``i`` to ``W[q]``; return how many there are, 0 if it does not move."""
    n = I[N_STATES]
    row = I[O_AFFINE] + 1 + i * (n + 1)
    found = 0
    for m in range(terms):
        W[q + m] = 0.0
    if W[row + n] != 0.0:
        W[q] = W[row + n] * h
        found = 1
    for j in range(n):
        share = W[row + j]
        if share != 0.0:
            found = terms
            for m in range(terms):
                W[q + m] += share * W[I[O_CONT] + (m + 1) * n + j]
    return found


@njit(cache=True, error_model="numpy", inner=True)
def take_affine(I, W, t, h, start):  # type: ignore[no-untyped-def]
    """Take C and d from signals around the states at the start of the step, where they are those at ``W[start]``."""
    n, ns = I[N_STATES], I[N_SIGNALS]
    model, x, s = I[O_AFFINE], I[O_X], I[O_S]
    copy(W, I[O_Y0], x, n)
    for j in range(n):
        before = W[x + j]
        W[x + j] = before + SHARE * max(abs(before), h * abs(W[I[O_K] + j]), 1e-6)
        change = W[x + j] - before
        signals(I, W, t)
        for i in range(ns):
            W[model + 1 + i * (n + 1) + j] = (W[s + i] - W[start + i]) / change
        W[x + j] = before
    later = 0.5 * (W[T_STOP] - t)
    if I[TIMED]:
        signals(I, W, t + later)
    for i in range(ns):
        W[model + 1 + i * (n + 1) + n] = (W[s + i] - W[start + i]) / later if I[TIMED] else 0.0
    W[model] = I[MODEL] + 1.0


@njit(cache=True, error_model="numpy")
def holds(I, W, passed, start):  # type: ignore[no-untyped-def]
    """Return whether the signals now are what C and d make of those ``passed`` [s] ago, at the start of the step."""
    n, row = I[N_STATES], I[O_AFFINE] + 1
    for i in range(I[N_SIGNALS]):
        expected = W[start + i] + passed * W[row + n]
        for j in range(n):
            expected += W[row + j] * (W[I[O_X] + j] - W[I[O_Y0] + j])
        row += n + 1
        now = W[I[O_S] + i]
        if not abs(now - expected) <= TRUST * (W[ATOL] + W[RTOL] * abs(now)):
            return False
    return True
