"""How long the next step is: after an event, after a step, after a refusal; and which method takes it.

After an event the step begins as it did after the last event into the same combination of modes, with the method
that was right there.
"""

import numpy as np
from stickslip.engine.layout import (
    ATOL,
    CROWDED,
    EVENTS,
    EVENTS_SEEN,
    EXPLICIT,
    LEARN,
    LOGGED,
    MAX_STEP,
    METHOD,
    METHOD_WISH,
    MODEL,
    N_BLOCKS,
    N_STATES,
    O_F,
    O_K,
    O_RESTART,
    O_X,
    O_Y0,
    OTHERWISE,
    RESTARTS,
    RTOL,
    STEP,
    STIFF_COUNT,
    T_STOP,
    D,
    H,
    R,
    T,
)
from stickslip.engine.sweep import rates
from stickslip.logs.compiled import njit

STIFF_STEPS = 12  # steps in a row at the stability limit before the stiff method takes over
EASY = 0.01  # an error so small asks for no shorter step
MOST_GROWTH = 10.0  # of a step over the one before
APART = 1e-6  # transitions that follow each other faster than this [s] crowd


@njit(cache=True, error_model="numpy", inner=True)
def mode_slot(I, W):  # type: ignore[no-untyped-def]
    """Return where the first step after an event into the present combination of modes is remembered."""
    key = 0
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + LOGGED]:
            key = (7 * key + int(W[I[row + D]]) + 64) % RESTARTS
    return key


@njit(cache=True, error_model="numpy", inner=True)
def restart(I, W):  # type: ignore[no-untyped-def]
    """Choose method and first step after an event; 0, to be guessed, where these modes are new."""
    slot = mode_slot(I, W)
    stiff = I[METHOD_WISH] == 2 or W[I[O_RESTART] + RESTARTS + slot] > 0.0
    I[METHOD] = 1 if stiff else I[EXPLICIT] if I[METHOD_WISH] == 0 else I[OTHERWISE]
    I[MODEL] = slot
    W[STEP] = W[I[O_RESTART] + slot]
    I[LEARN] = slot + 1
    I[EVENTS_SEEN] = I[EVENTS]
    if I[CROWDED]:
        W[STEP] = min(W[STEP], APART)
        I[LEARN] = 0


@njit(cache=True, error_model="numpy", inner=True)
def first_step(I, W):  # type: ignore[no-untyped-def]
    """Guess a first step from the size of the state, its rate and one probing Euler step."""
    n = I[N_STATES]
    size, rate, bend = 0.0, 0.0, 0.0
    y0, k, x, f = I[O_Y0], I[O_K], I[O_X], I[O_F]
    for i in range(n):
        scale = W[ATOL] + W[RTOL] * abs(W[y0 + i])
        size = max(size, abs(W[y0 + i]) / scale)
        rate = max(rate, abs(W[k + i]) / scale)
    trial = 1e-6 if size < 1e-5 or rate < 1e-5 else 0.01 * size / rate
    trial = min(trial, W[T_STOP] - W[T], W[MAX_STEP])
    for i in range(n):
        W[x + i] = W[y0 + i] + trial * W[k + i]
    rates(I, W, W[T] + trial)
    for i in range(n):
        scale = W[ATOL] + W[RTOL] * abs(W[y0 + i])
        bend = max(bend, abs(W[f + i] - W[k + i]) / scale / trial)
    fastest = max(rate, bend)
    guess = max(1e-6, trial * 1e-3) if fastest <= 1e-15 else (0.01 / fastest) ** 0.2
    if not np.isfinite(guess):
        return trial
    return min(100.0 * trial, guess)


@njit(cache=True, error_model="numpy")
def proposed(W, left):  # type: ignore[no-untyped-def]
    """Return the step to try, with ``left`` [s] to the next stop: never a sliver before it."""
    h = min(W[STEP], W[MAX_STEP])
    if h >= left * (1.0 - 1e-12):
        return left
    return 0.5 * left if h > 0.5 * left else h


@njit(cache=True, error_model="numpy", inner=True)
def after_refusal(W, h, error, power):  # type: ignore[no-untyped-def]
    """Shorten the proposal after a step whose ``error`` was too large."""
    W[STEP] = h * max(0.1, 0.9 * error ** (-power)) if np.isfinite(error) else 0.1 * h


@njit(cache=True, error_model="numpy")
def after_step(I, W, h, left, error, power, refused):  # type: ignore[no-untyped-def]
    """Propose the step after one that was accepted, perhaps after tries that were ``refused``."""
    longer = W[STEP] / h
    if h >= left and not refused and I[LEARN] == 0 and (longer >= MOST_GROWTH or (longer >= 1.5 and error <= EASY)):
        return  # it ended at an instant, and what was proposed before is more than could be now, or long enough
    best = 0.9 * max(error, 1e-15) ** (-power)
    if I[LEARN] > 0:
        W[I[O_RESTART] + I[LEARN] - 1] = h * min(100.0, best)
        I[LEARN] = 0
    growth = min(MOST_GROWTH if I[METHOD] >= 2 else 5.0, max(0.2, best))
    if refused:
        growth = min(growth, 1.0)
    if h < left or growth < 1.0:
        W[STEP] = h * growth
    else:
        W[STEP] = max(W[STEP], h * growth)


@njit(cache=True, error_model="numpy", inner=True)
def watch_stiffness(I, W, limited):  # type: ignore[no-untyped-def]
    """Count explicit steps that stability limits, if the method is free; after many take the stiff one in these modes.

    The count goes on over events: modes that change every few steps would otherwise hide that they are stiff.
    """
    if I[METHOD] != 1 and I[METHOD_WISH] == 0:
        I[STIFF_COUNT] = I[STIFF_COUNT] + 1 if limited else max(0, I[STIFF_COUNT] - 1)
        if I[STIFF_COUNT] >= STIFF_STEPS:
            I[METHOD] = 1
            I[STIFF_COUNT] = 0
            W[I[O_RESTART] + RESTARTS + mode_slot(I, W)] = 1.0
