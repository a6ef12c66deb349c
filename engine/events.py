"""Events: crossings located on the dense output, transitions applied, and everything that happens at one instant.

An event function fires when it becomes positive.  A transition must leave its block's event functions at or
below zero; transitions that follow at once from others (slip, then stick) are carried out in a chain.
"""

import numpy as np
from numba import njit

from engine.call import call
from engine.dense import interpolate
from engine.layout import (
    A_JUMP,
    A_NEXT,
    A_STEP,
    A_ZC,
    CHAIN,
    CONTINUOUS,
    COUNT,
    EV_COUNT,
    EVENTS,
    FEEDS,
    GLOBAL,
    HAS_RATES,
    KIND,
    LOGGED,
    MAX_CHAIN,
    MAX_STEP,
    N_BLOCKS,
    N_EVENTS,
    N_SIGNALS,
    ND,
    NEXT_TIME,
    NG,
    NU,
    O_G,
    O_G0,
    O_S,
    O_S0,
    O_SCRATCH,
    O_X,
    OFFSET,
    PERIOD,
    RATES,
    SAMPLED,
    T_LEFT,
    T_STOP,
    WIRES,
    D,
    G,
    H,
    P,
    R,
    T,
    U,
    X,
    Y,
)
from engine.sweep import clock, evaluate_events, gather, gather_with_rates, signals

IMPULSE = 1e12  # rate that stands for a jump of a signal


@njit(cache=True, error_model="numpy")
def fire(I, W, EV, row, which):  # type: ignore[no-untyped-def]
    """Let one block make the transition of its event function ``which`` and note it in the event log."""
    d = I[row + D]
    before = W[d] if I[row + ND] > 0 else 0.0
    W[I[O_G] + I[row + G]] = which
    call(
        I[row + A_JUMP],
        W[T],
        W,
        I[O_X] + I[row + X],
        d,
        I[row + U],
        I[row + P],
        I[O_G] + I[row + G],
    )
    I[EVENTS] += 1
    I[CHAIN] += 1
    if I[row + LOGGED] and W[d] != before and I[EV_COUNT] < EV.shape[0]:
        EV[I[EV_COUNT], 0] = W[T]
        EV[I[EV_COUNT], 1] = I[row + GLOBAL]
        EV[I[EV_COUNT], 2] = before
        EV[I[EV_COUNT], 3] = W[d]
        I[EV_COUNT] += 1


@njit(cache=True, error_model="numpy")
def fire_positive(I, W, EV):  # type: ignore[no-untyped-def]
    """Fire the first positive event function of every block; inputs and rates must be current."""
    fired = False
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        for i in range(I[row + NG]):
            if W[I[O_G] + I[row + G] + i] > 0.0:
                gather_with_rates(I, W, row)
                fire(I, W, EV, row, i)
                fired = True
                break
    return fired


@njit(cache=True, error_model="numpy")
def fire_on_jumps(I, W, EV):  # type: ignore[no-untyped-def]
    """Show signal jumps as impulses, at their old value, to the blocks that watch the rate of an input."""
    fired = False
    s, s0 = I[O_S], I[O_S0]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + RATES] and I[row + NG] > 0:
            jumped = False
            nu = I[row + NU]
            for i in range(nu):
                wire = I[I[row + WIRES] + i]
                jump = W[s + wire] - W[s0 + wire]
                jumped = jumped or jump != 0.0
                W[I[row + U] + i] = W[s0 + wire]
                W[I[row + U] + nu + i] = IMPULSE * jump
            if jumped:
                g = I[O_G] + I[row + G]
                call(I[row + A_ZC], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], g)
                for i in range(I[row + NG]):
                    if W[g + i] > 0.0:
                        fire(I, W, EV, row, i)
                        fired = True
                        break
    for i in range(I[N_SIGNALS]):
        W[s0 + i] = W[s + i]
    return fired


@njit(cache=True, error_model="numpy")
def settle(I, W, EV, scale):  # type: ignore[no-untyped-def]
    """Carry out all transitions of the present instant; return False if they never end."""
    while True:
        signals(I, W, W[T])
        if I[HAS_RATES] and fire_on_jumps(I, W, EV):
            if I[CHAIN] > I[MAX_CHAIN]:
                return False
            continue
        evaluate_events(I, W, W[T], scale)
        if not fire_positive(I, W, EV):
            return True
        if I[CHAIN] > I[MAX_CHAIN]:
            return False


@njit(cache=True, error_model="numpy")
def sample(I, W):  # type: ignore[no-untyped-def]
    """Run the sampled blocks that are due now: those without feedthrough publish first, then all in flow order."""
    now = W[T] + clock(W)
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED and not I[row + FEEDS] and due(I, W, row) <= now:
            for i in range(I[row + ND]):
                W[I[O_SCRATCH] + i] = W[I[row + D] + i]
            run_step(I, W, row)
            for i in range(I[row + ND]):
                W[I[row + D] + i] = W[I[O_SCRATCH] + i]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED and due(I, W, row) <= now:
            signals(I, W, W[T])
            run_step(I, W, row)
            I[row + COUNT] += 1


@njit(cache=True, error_model="numpy")
def due(I, W, row):  # type: ignore[no-untyped-def]
    """Return the next sampling instant of a block, counted, so that rounding cannot drift."""
    return W[I[row + OFFSET]] + I[row + COUNT] * W[I[row + PERIOD]]


@njit(cache=True, error_model="numpy")
def run_step(I, W, row):  # type: ignore[no-untyped-def]
    """Take one sample of one block: new memory, new held outputs."""
    gather(I, W, row)
    call(
        I[row + A_STEP],
        W[T],
        W,
        I[O_X] + I[row + X],
        I[row + D],
        I[row + U],
        I[row + P],
        I[O_S] + I[row + Y],
    )


@njit(cache=True, error_model="numpy")
def begin_instant(I, W):  # type: ignore[no-untyped-def]
    """Look at the present from its right side: keep the signals before it, lift the left limit."""
    s, s0 = I[O_S], I[O_S0]
    for i in range(I[N_SIGNALS]):
        W[s0 + i] = W[s + i]
    W[T_LEFT] = np.inf


@njit(cache=True, error_model="numpy")
def next_stop(I, W, t_end):  # type: ignore[no-untyped-def]
    """Find the next instant not to be stepped over and the largest step that the sources allow."""
    stop = t_end
    largest = np.inf
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED:
            stop = min(stop, due(I, W, row))
        elif I[row + KIND] == CONTINUOUS and I[row + A_NEXT] != 0:
            at = I[row + NEXT_TIME]
            call(I[row + A_NEXT], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], at)
            if W[at] > W[T]:
                stop = min(stop, W[at])
            largest = min(largest, W[at + 1])
    W[T_STOP] = stop
    W[MAX_STEP] = largest


@njit(cache=True, error_model="numpy")
def highest(I, W):  # type: ignore[no-untyped-def]
    """Return the largest event function among those that were not positive at the left of the interval."""
    top = -np.inf
    for i in range(I[N_EVENTS]):
        if W[I[O_G0] + i] <= 0.0:
            top = max(top, W[I[O_G] + i])
    return top


@njit(cache=True, error_model="numpy")
def at_fraction(I, W, t, h, s):  # type: ignore[no-untyped-def]
    """Evaluate the event functions at the fraction ``s`` of the step; return the largest."""
    interpolate(I, W, s)
    evaluate_events(I, W, t + s * h, min(1.0, h))
    return highest(I, W)


@njit(cache=True, error_model="numpy")
def first_crossing(I, W, t, h):  # type: ignore[no-untyped-def]
    """Return the fraction of the step at which the first event fires, or 2 if none does.

    Looks at the end and at the middle, where an event may come and go, then closes in by the Illinois rule with
    bisection every third time.  Leaves the event functions of the end behind ``W[O_G]``.
    """
    ng = I[N_EVENTS]
    end = at_fraction(I, W, t, h, 1.0)
    for i in range(ng):
        W[I[O_G] + ng + i] = W[I[O_G] + i]
    left, right = 0.0, 0.5
    top = at_fraction(I, W, t, h, 0.5)
    low = -np.inf
    if top <= 0.0:
        if end <= 0.0:
            return 2.0
        left, right, low, top = 0.5, 1.0, top, end
    else:
        low = at_fraction(I, W, t, h, 0.0)
        if low > 0.0:
            return 0.0
    resolution = clock(W) / h
    for turn in range(200):
        if right - left <= resolution:
            break
        if turn % 3 == 2 or not np.isfinite(low):
            s = 0.5 * (left + right)
        else:
            s = left + (right - left) * low / (low - top)
            s = min(max(s, left + 0.5 * resolution), right - 0.5 * resolution)
        value = at_fraction(I, W, t, h, s)
        if value > 0.0:
            right, top = s, value
            low *= 0.5
        else:
            left, low = s, value
            top *= 0.5
    return right
