"""Events: transitions, everything else that happens at one instant, and the instants not to be stepped over.

An event function fires when it becomes positive.  A transition must leave its block's event functions at or
below zero; transitions that follow at once from others (slip, then stick) are carried out in a chain.
"""

import numpy as np
from stickslip.engine.call import call
from stickslip.engine.delay import happens
from stickslip.engine.layout import (
    A_JUMP,
    A_NEXT,
    A_ZC,
    ATOL,
    CHAIN,
    CONTINUOUS,
    CURRENT,
    EV_COUNT,
    EV_ROOM,
    EVENTS,
    EVENTS_SEEN,
    GLOBAL,
    HAS_RATES,
    KIND,
    L_INSTANTS,
    L_WATCHING,
    LOGGED,
    LONGEST,
    MAX_CHAIN,
    MAX_STEP,
    N_BLOCKS,
    N_EVENTS,
    N_INSTANTS,
    N_WATCHING,
    ND,
    NEXT_TIME,
    NG,
    NU,
    O_G,
    O_G0,
    O_S,
    O_X,
    RATE_MODES,
    RATES,
    RATES_NOW,
    RTOL,
    SHOWN,
    SMOOTH_STOP,
    T_LEFT,
    T_STOP,
    TABLE,
    TAKES,
    WIRES,
    D,
    G,
    H,
    P,
    R,
    T,
    U,
    X,
)
from stickslip.engine.sampling import begin_run, due
from stickslip.engine.sweep import events_of_signals, gather_with_rates, rates, resolution, signal_rates, signals
from stickslip.logs.compiled import njit

IMPULSE = 1e12  # rate that stands for a jump of a signal


@njit(cache=True, error_model="numpy", inner=True)
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
    happens(I, row, 0)
    if I[row + LOGGED] and W[d] != before:
        note(I, W, EV, row, before)


@njit(cache=True, error_model="numpy")
def note(I, W, EV, row, before):  # type: ignore[no-untyped-def]
    """Write a change of mode to the event log."""
    if I[EV_COUNT] < I[EV_ROOM]:
        at = 4 * I[EV_COUNT]
        EV[at], EV[at + 1], EV[at + 2], EV[at + 3] = W[T], I[row + GLOBAL], before, W[I[row + D]]
        I[EV_COUNT] += 1


@njit(cache=True, error_model="numpy", inner=True)
def looks_at_rates(I, W, row):  # type: ignore[no-untyped-def]
    """Return whether the event functions of a block look at the rates of its inputs in its present mode."""
    if not I[row + RATES] or I[row + NG] == 0:
        return False
    modes = I[row + RATE_MODES]
    for m in range(I[modes]):
        if W[I[row + D]] == I[modes + 1 + m]:
            return True
    return I[modes] == 0


@njit(cache=True, error_model="numpy", inner=True)
def watch_rates(I, W):  # type: ignore[no-untyped-def]
    """Note whether any event functions look at rates in the present modes."""
    I[RATES_NOW] = 0
    for b in range(I[N_BLOCKS]):
        if looks_at_rates(I, W, H + b * R):
            I[RATES_NOW] = 1


@njit(cache=True, error_model="numpy", inner=True)
def fire_positive(I, W, EV):  # type: ignore[no-untyped-def]
    """Fire the first positive event function of every block; inputs must be current, and rates where they are watched.

    A transition may look at rates that no event function of its mode looks at.
    """
    waiting = False
    for i in range(I[N_EVENTS]):
        waiting = waiting or W[I[O_G] + i] > 0.0
    if not waiting:
        return False
    if I[HAS_RATES] and not I[RATES_NOW]:
        rates(I, W, W[T])
        signal_rates(I, W, W[T])
    fired = False
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        for i in range(I[row + NG]):
            if W[I[O_G] + I[row + G] + i] > 0.0:
                gather_with_rates(I, W, row)
                fire(I, W, EV, row, i)
                fired = True
                break
    watch_rates(I, W)
    return fired


@njit(cache=True, error_model="numpy", inner=True)
def fire_waiting(I, W, EV):  # type: ignore[no-untyped-def]
    """Fire what had not been positive at the left of the interval; the rest belongs to ``settle``."""
    for i in range(I[N_EVENTS]):
        if W[I[O_G0] + i] > 0.0:
            W[I[O_G] + i] = -1.0
    fire_positive(I, W, EV)


@njit(cache=True, error_model="numpy", inner=True)
def show_jump(I, W, EV, row):  # type: ignore[no-untyped-def]
    """Show a block that watches rates what its inputs have jumped by since it was last shown; return whether they have.

    It sees the jump as an impulse at the old value.  What is far below the tolerances is rounding, for example where a
    breakpoint leaves a dead time, and no jump.
    """
    jumped = False
    nu, u, shown, wires = I[row + NU], I[row + U], I[row + SHOWN], I[row + WIRES]
    for i in range(nu):
        now, before = W[I[O_S] + I[wires + i]], W[shown + i]
        jump = now - before
        if abs(jump) <= 1e-3 * W[ATOL] + (1e-3 * W[RTOL] + 1e-14) * abs(now):
            jump = 0.0
        jumped = jumped or jump != 0.0
        W[u + i], W[u + nu + i], W[shown + i] = before, IMPULSE * jump, now
    if jumped and looks_at_rates(I, W, row):
        g = I[O_G] + I[row + G]
        call(I[row + A_ZC], W[T], W, I[O_X] + I[row + X], I[row + D], u, I[row + P], g)
        for i in range(I[row + NG]):
            if W[g + i] > 0.0:
                fire(I, W, EV, row, i)
                break
    return jumped


@njit(cache=True, error_model="numpy", inner=True)
def fire_on_jumps(I, W, EV):  # type: ignore[no-untyped-def]
    """Show signal jumps to all blocks that watch rates; return whether any transition follows."""
    before = I[EVENTS]
    for k in range(I[N_WATCHING]):
        show_jump(I, W, EV, I[I[L_WATCHING] + k])
    if I[EVENTS] != before:
        watch_rates(I, W)
    return I[EVENTS] != before


@njit(cache=True, error_model="numpy")
def settle(I, W, EV):  # type: ignore[no-untyped-def]
    """Carry out all transitions of the present instant; return False if they never end.

    The first sweep is left out where turns have just made one (``CURRENT``).
    """
    while True:
        if not I[CURRENT]:
            signals(I, W, W[T])
        I[CURRENT] = 0
        if I[HAS_RATES] and fire_on_jumps(I, W, EV):
            if I[CHAIN] > I[MAX_CHAIN]:
                return False
            continue
        events_of_signals(I, W, W[T])
        if not fire_positive(I, W, EV):
            return True
        if I[CHAIN] > I[MAX_CHAIN]:
            return False


@njit(cache=True, error_model="numpy", inner=True)
def begin_instant(I, W):  # type: ignore[no-untyped-def]
    """Look at the present from its right side: keep what may jump as it is before it, lift the left limit."""
    if I[EVENTS_SEEN] == -1:
        begin_run(I, W)
    keep_inputs(I, W)
    W[T_LEFT] = np.inf


@njit(cache=True, error_model="numpy", inner=True)
def keep_inputs(I, W):  # type: ignore[no-untyped-def]
    """Keep the inputs of the blocks that watch rates: what they are next differs from them by a jump."""
    for k in range(I[N_WATCHING]):
        row = I[I[L_WATCHING] + k]
        for i in range(I[row + NU]):
            W[I[row + SHOWN] + i] = W[I[O_S] + I[I[row + WIRES] + i]]


@njit(cache=True, error_model="numpy", inner=True)
def stop_at(I, W, at):  # type: ignore[no-untyped-def]
    """Do not step over ``at``; instants that differ by rounding only are one, at the last of them.

    While stops are collected, ``T_LEFT`` holds the first instant of the cluster and ``T_STOP`` the last.
    """
    near = resolution(W[T_LEFT])  # an instant may lie at infinity
    if at < W[T_LEFT] - near:
        W[T_LEFT] = W[T_STOP] = at
    elif at <= W[T_LEFT] + near:
        W[T_LEFT] = min(W[T_LEFT], at)
        W[T_STOP] = max(W[T_STOP], at)


@njit(cache=True, error_model="numpy")
def next_stop(I, W, t_end):  # type: ignore[no-untyped-def]
    """Find the next instant not to be stepped over and the largest step that the run and its sources allow."""
    W[T_LEFT] = W[T_STOP] = t_end
    I[SMOOTH_STOP] = 0
    largest = W[LONGEST]
    for k in range(I[N_INSTANTS]):
        row = I[I[L_INSTANTS] + k]
        if I[row + TAKES] or I[row + TABLE] != 0:
            stop_at(I, W, due(I, W, row))
        if I[row + KIND] == CONTINUOUS and I[row + A_NEXT] != 0:
            at = I[row + NEXT_TIME]
            call(I[row + A_NEXT], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], at)
            if W[at] > W[T]:
                stop_at(I, W, W[at])
            largest = min(largest, W[at + 1])
    W[MAX_STEP] = largest
