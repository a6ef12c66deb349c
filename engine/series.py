"""Steps of components that are linear in each mode: the series of the matrix exponential, exact to the last term kept.

Between two instants, while no mode changes, the rates of such a component are affine in states and time,

    dx/dt = f + A (x - x_0) + g (t - t_0),        x(t_0 + s h) = x_0 + sum_m p_m s^m,
    p_1 = h f,   p_2 = h/2 (A p_1 + h g),   p_(m+1) = h/(m+1) A p_m,

so a step costs one product with a small matrix a term in place of a sweep over all blocks a stage, and the terms are
the dense output.  A and g are differences of the rates, kept for each combination of modes.  Where steps of one
length h follow each other in one mode, as between samples, the sums are taken once, with all terms there is room for,

    x(t_0 + h) = x_0 + E f + e,      x(t_0 + h/2) = x_0 + H f + k,

and the terms themselves only where something happens inside the step.

Nothing is taken on trust: at the end of every step the blocks say what their rates are.  Where these differ from those
of the series, A and g are taken anew (a memory may have changed them); if that does not help, either an event lies in
the step, up to which the series holds, or the step is refused and tried shorter.  Where rates are not affine another
method takes the step.
"""

import numpy as np
from stickslip.engine.floats import copy, finite
from stickslip.engine.layout import (
    ATOL,
    DENSE_TERMS,
    MODEL,
    N_CHECKED,
    N_EVENTS,
    N_STATES,
    O_AGAIN,
    O_CONT,
    O_F,
    O_G,
    O_G0,
    O_K,
    O_MODEL,
    O_S,
    O_TMP,
    O_X,
    O_Y0,
    O_Y1,
    RTOL,
    SERIES,
    T_STOP,
    TIMED,
)
from stickslip.engine.sweep import events_of_signals, rates
from stickslip.logs.compiled import njit

ENOUGH = 1e-3  # terms are added until the last one is this share of the tolerance
TRUST = 0.05  # so much, as a share of the tolerance, may the rates at the end move the states off the series
SHARE = 1e-3  # of a state: by how much it is changed to see what follows it
PLACES = np.array([0.0, 0.02, 0.5])  # shares of a step at which that is tried
AGAIN = 4  # floats before E: 1 + the mode of the kept step and its length; the same of the last step
AT_LIMIT = 6.0  # h |A| beyond this says that a mode is far slower than its fastest part


def model_size(n: int) -> int:
    """Return how many floats A, g and the mark that they are known take, of ``n`` states."""
    return 1 + n * n + n


def again_size(n: int) -> int:
    """Return how many floats a kept step takes, of ``n`` states: see ``keep_step``."""
    return AGAIN + 3 * n * (n + 1)


@njit(cache=True, error_model="numpy", inner=True)
def series_step(I, W, t, h):  # type: ignore[no-untyped-def]
    """Try one step from ``W[O_Y0]`` (rates there at ``W[O_K]``).

    Return (error norm, terms, whether h |A| is at its limit).  The norm is infinite if nothing was finite at the end,
    4 for a step that holds more than the series describes, and -1 if there is no series here.
    """
    n = I[N_STATES]
    model = I[O_MODEL] + I[MODEL] * (1 + n * n + n)
    fresh = W[model] == 0.0
    if fresh and not identify(I, W, t, h, model):
        return -1.0, 1, False
    again = comes_again(I, W, h, model)
    while True:
        error, terms, ratio = 2.0 * ENOUGH, SERIES - 1, 0.0
        if again:
            error = step_again(I, W)
        if error > ENOUGH:
            error, terms, ratio = add_terms(I, W, h, model)
        if not error <= 1.0:
            return error, terms, False
        copy(W, I[O_Y1], I[O_X], n)
        rates(I, W, t + h)
        if not finite(W, I[O_F], n) or not finite(W, I[O_S], I[N_CHECKED]):
            return np.inf, terms, False
        if defect(I, W, h, model) <= TRUST:
            return error, terms, ratio > AT_LIMIT
        if fresh:
            break
        fresh, again = True, False
        if not identify(I, W, t, h, model):
            return -1.0, 1, False
    if event_at_end(I, W, t, h):
        copy(W, I[O_Y1], I[O_X], n)
        return error, terms, False
    return 4.0, 2, False


@njit(cache=True, error_model="numpy", inner=True)
def comes_again(I, W, h, model):  # type: ignore[no-untyped-def]
    """Return whether a step of this length in this mode is kept; keep it if it is the second in a row."""
    again, mode = I[O_AGAIN], I[MODEL] + 1.0
    if W[again] == mode and W[again + 1] == h:
        return True
    second = W[again + 2] == mode and W[again + 3] == h
    W[again + 2], W[again + 3] = mode, h
    if second:
        keep_step(I, W, h, model)
    return second


@njit(cache=True, error_model="numpy", inner=True)
def keep_step(I, W, h, model):  # type: ignore[no-untyped-def]
    """Write (E, e), (H, k) and the last terms of E and e, each column by column, behind ``W[O_AGAIN]``."""
    n, again = I[N_STATES], I[O_AGAIN]
    W[again], W[again + 1] = I[MODEL] + 1.0, h
    whole = again + AGAIN
    half, last = whole + n * (n + 1), whole + 2 * n * (n + 1)
    for column in range(n + 1):
        here, there = I[O_CONT], I[O_CONT] + n
        for i in range(n):
            W[here + i] = h if i == column else 0.0
            W[whole + column * n + i], W[half + column * n + i] = W[here + i], 0.5 * W[here + i]
        share = 0.5
        for m in range(2, SERIES):
            share *= 0.5
            for i in range(n):
                total = h * W[model + 1 + n * n + i] if column == n and m == 2 else 0.0
                for j in range(n):
                    total += W[model + 1 + i * n + j] * W[here + j]
                W[there + i] = total * h / m
                W[whole + column * n + i] += W[there + i]
                W[half + column * n + i] += share * W[there + i]
            here, there = there, here
        copy(W, here, last + column * n, n)


@njit(cache=True, error_model="numpy", inner=True)
def step_again(I, W):  # type: ignore[no-untyped-def]
    """Write the end of a kept step to ``W[O_Y1]``; return its last term as ``add_terms`` does."""
    n = I[N_STATES]
    k, y0, y1, inverse = I[O_K], I[O_Y0], I[O_Y1], I[O_TMP]
    whole = I[O_AGAIN] + AGAIN
    last = whole + 2 * n * (n + 1)
    norm = 0.0
    for i in range(n):
        total, left = W[whole + n * n + i], W[last + n * n + i]
        for j in range(n):
            total += W[whole + j * n + i] * W[k + j]
            left += W[last + j * n + i] * W[k + j]
        W[y1 + i] = W[y0 + i] + total
        W[inverse + i] = 1.0 / (W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i])))
        norm = max(norm, abs(left) * W[inverse + i])
    I[DENSE_TERMS] = 0
    return norm


@njit(cache=True, error_model="numpy", inner=True)
def half_again(I, W):  # type: ignore[no-untyped-def]
    """Write the middle of a kept step to ``W[O_X]``."""
    n = I[N_STATES]
    half = I[O_AGAIN] + AGAIN + n * (n + 1)
    for i in range(n):
        total = W[half + n * n + i]
        for j in range(n):
            total += W[half + j * n + i] * W[I[O_K] + j]
        W[I[O_X] + i] = W[I[O_Y0] + i] + total


@njit(cache=True, error_model="numpy", inner=True)
def make_terms(I, W):  # type: ignore[no-untyped-def]
    """Make the terms of a kept step, whose end stays as it is."""
    n = I[N_STATES]
    copy(W, I[O_Y1], I[O_X], n)
    add_terms(I, W, W[I[O_AGAIN] + 1], I[O_MODEL] + I[MODEL] * (1 + n * n + n))
    copy(W, I[O_X], I[O_Y1], n)


@njit(cache=True, error_model="numpy", inner=True)
def add_terms(I, W, h, model):  # type: ignore[no-untyped-def]
    """Write the terms to ``W[O_CONT]`` and their sum to ``W[O_Y1]``; return (last term, terms, h |A| as terms show it).

    The last term is measured in tolerances; their inverse stands at ``W[O_TMP]``.
    """
    n = I[N_STATES]
    k, y0, y1, c, inverse = I[O_K], I[O_Y0], I[O_Y1], I[O_CONT], I[O_TMP]
    norm, last, m = 0.0, 0.0, 1
    for i in range(n):
        first = h * W[k + i]
        W[c + i] = W[y0 + i]
        W[c + n + i] = first
        W[y1 + i] = W[y0 + i] + first
        W[inverse + i] = 1.0 / (W[ATOL] + W[RTOL] * max(abs(W[y0 + i]), abs(W[y1 + i])))
        norm = max(norm, abs(first) * W[inverse + i])
    while m < SERIES - 1:
        m += 1
        last, norm = norm, 0.0
        before, here, share, row = c + (m - 1) * n, c + m * n, h / m, model + 1
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += W[row + j] * W[before + j]
            row += n
            if m == 2:
                total += h * W[model + 1 + n * n + i]
            total *= share
            W[here + i] = total
            W[y1 + i] += total
            norm = max(norm, abs(total) * W[inverse + i])
        if norm <= ENOUGH and norm <= last:
            break
    I[DENSE_TERMS] = -(m + 1)
    return norm, m, m * norm / max(last, 1e-300)


@njit(cache=True, error_model="numpy")
def defect(I, W, h, model):  # type: ignore[no-untyped-def]
    """Return how far the rates at the end could have moved a state off the series, in tolerances."""
    n = I[N_STATES]
    worst, row = 0.0, model + 1
    for i in range(n):
        expected = W[I[O_K] + i] + h * W[model + 1 + n * n + i]
        for j in range(n):
            expected += W[row + j] * (W[I[O_Y1] + j] - W[I[O_Y0] + j])
        row += n
        worst = max(worst, 0.5 * h * abs(W[I[O_F] + i] - expected) * W[I[O_TMP] + i])
    return worst


@njit(cache=True, error_model="numpy", inner=True)
def identify(I, W, t, h, model):  # type: ignore[no-untyped-def]
    """Take A and g from rates around the present states or, where these lie on the edge of their mode, farther on.

    Return whether the rates are affine there: changed one way, they change as much as the other way.
    """
    W[I[O_AGAIN]] = W[I[O_AGAIN] + 2] = 0.0
    for place in range(len(PLACES)):
        if taken_at(I, W, t, h, model, PLACES[place]):
            W[model] = 1.0
            return True
    W[model] = 0.0
    return False


@njit(cache=True, error_model="numpy", inner=True)
def taken_at(I, W, t, h, model, place):  # type: ignore[no-untyped-def]
    """Take A and g at this share of the step along the present rates; return whether the rates are affine there."""
    n = I[N_STATES]
    x, f, k, y0, here = I[O_X], I[O_F], I[O_K], I[O_Y0], I[O_K] + I[N_STATES]  # the second slot of stages is free
    for i in range(n):
        W[x + i] = W[y0 + i] + place * h * W[k + i]
    rates(I, W, t)
    copy(W, f, here, n)
    affine = True
    for j in range(n):
        start, moves = W[x + j], h * abs(W[k + j])
        change = SHARE * max(abs(start), moves, 1e-6)
        W[x + j] = start + change
        up = W[x + j] - start
        rates(I, W, t)
        for i in range(n):
            W[model + 1 + i * n + j] = W[f + i] - W[here + i]
        W[x + j] = start - change
        down = start - W[x + j]
        rates(I, W, t)
        for i in range(n):
            rise, fall = W[model + 1 + i * n + j] / up, (W[here + i] - W[f + i]) / down
            scale = W[ATOL] + W[RTOL] * abs(W[y0 + i])
            unlike = abs(rise - fall)
            affine = affine and (unlike <= 1e-6 * (abs(rise) + abs(fall)) or 0.5 * h * moves * unlike <= TRUST * scale)
            W[model + 1 + i * n + j] = 0.5 * (rise + fall)
        W[x + j] = start
    later = 0.5 * (W[T_STOP] - t)
    if I[TIMED]:
        rates(I, W, t + later)
    for i in range(n):
        W[model + 1 + n * n + i] = (W[f + i] - W[here + i]) / later if I[TIMED] else 0.0
    return affine


@njit(cache=True, error_model="numpy", inner=True)
def event_at_end(I, W, t, h):  # type: ignore[no-untyped-def]
    """Return whether an event fires within the step, as its end shows; signals and rates must be those of the end."""
    if I[N_EVENTS] == 0:
        return False
    events_of_signals(I, W, t + h)
    fires = False
    for i in range(I[N_EVENTS]):
        fires = fires or (W[I[O_G0] + i] <= 0.0 and W[I[O_G] + i] > 0.0)
    return fires
