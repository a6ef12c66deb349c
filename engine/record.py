"""Signals that enter dead times during a step: they are recorded, and no step jumps over the instant they leave.

``delay`` keeps and reads the records; here the states between the ends of a step are turned into signals, and the
breakpoints ahead into stops.

Breakpoints of several dead times multiply: after k passes there is one for every sum of k dead times.  But each pass
through an integrator makes them smoother, and what is smooth enough need not be met exactly.  A method of order p takes
steps h with (h/T)^p/p! = rtol, which shows the time T on which the signals change; there a breakpoint of level L (the
L-th derivative jumps) at the distance D from the end of the step does D^(L+1)/(T^L (L+1)!) h/D at most.  So it may lie
inside a step if D <= h ((L+1)! rtol)^(1/(L+1)) / (p! rtol)^(1/p).  That leaves level 0 where it is, lets those of level
2 and 3 fall together by the dozen, and forgets what is smoother than the order of the method.  It is a guess about the
size of what comes out; a step for which it is too bold is refused like any other and tried shorter.
"""

import numpy as np
from stickslip.engine.delay import SMOOTH, close_record, happens, let_out, open_record
from stickslip.engine.dense import interpolate
from stickslip.engine.events import stop_at
from stickslip.engine.layout import (
    A_NEXT,
    BREAK,
    CAPACITY,
    D_LEVEL,
    D_NODES,
    D_SIZE,
    D_T,
    D_V,
    DELAY,
    ENTERS,
    HEAD,
    L_DELAYS,
    L_REPLAYED,
    MAX_STEP,
    METHOD,
    N_BLOCKS,
    N_DELAYS,
    N_REPLAYED,
    NEEDED,
    NEXT_TIME,
    O_S,
    P_ENTERING,
    RESTS,
    RTOL,
    SMOOTH_STOP,
    STEP,
    T_LEFT,
    T_STOP,
    WIRES,
    H,
    P,
    R,
    T,
)
from stickslip.engine.sweep import play, resolution
from stickslip.logs.compiled import njit

KINK = 1  # a breakpoint of this level is still an instant: rates of signals jump there
NO_JUMP = 1e-3  # a jump smaller than this share of the tolerance is rounding
ORDERS = np.array([5.0, 5.0, 8.0])
FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0, 40320.0, 362880.0, 3628800.0])


@njit(cache=True, error_model="numpy", inner=True)
def store_delays(I, W, t, h, part):  # type: ignore[no-untyped-def]
    """Record what enters each dead time during the used part of the step; return False if a ring is full."""
    for k in range(I[N_DELAYS]):
        row = I[I[L_DELAYS] + k]
        at = open_record(I, W, row, t, part * h)
        if at < 0:
            return False
        for m in range(D_NODES):  # for what stands still that is all, and others may read it at once
            W[at + m] = W[I[O_S] + I[I[row + WIRES]]]
    for m in range(D_NODES):
        s = m / (D_NODES - 1.0) * part
        interpolate(I, W, s)
        play(I, W, t + s * h, P_ENTERING)
        for k in range(I[N_DELAYS]):
            row = I[I[L_DELAYS] + k]
            last = I[row + HEAD] - 1
            at = I[row + DELAY] + (last % I[row + CAPACITY]) * D_SIZE + D_V
            W[at + m] = W[I[O_S] + I[I[row + WIRES]]]
    for k in range(I[N_DELAYS]):
        close_record(I, W, I[I[L_DELAYS] + k], NO_JUMP)
    return True


@njit(cache=True, error_model="numpy")
def arrive(I, W):  # type: ignore[no-untyped-def]
    """Let what leaves a dead time, or what a source does, by the present instant reach the dead times behind."""
    now = W[T] + resolution(W[T])
    for k in range(I[N_REPLAYED]):
        let_out(I, W, I[I[L_REPLAYED] + k], now)
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + A_NEXT] != 0 and abs(W[I[row + NEXT_TIME]] - W[T]) <= now - W[T]:
            happens(I, row, 0)


@njit(cache=True, error_model="numpy", inner=True)
def limit_by_delays(I, W):  # type: ignore[no-untyped-def]
    """Stop at breakpoints that the method sees, and never step further than what is needed within the step is known."""
    for k in range(I[N_REPLAYED]):
        row = I[I[L_REPLAYED] + k]
        if I[row + NEEDED] and (not I[row + RESTS] or I[row + ENTERS] < SMOOTH):
            W[MAX_STEP] = min(W[MAX_STEP], W[I[row + P]])
            if I[row + ENTERS] == 0:  # it will stand in the record of the step ahead, and leave at its end
                stop_at(I, W, W[T] + W[I[row + P]])
    latest = np.inf
    for k in range(I[N_REPLAYED]):
        row = I[I[L_REPLAYED] + k]
        if I[row + NEEDED]:
            latest = latest_end(I, W, row, latest)
    if latest < W[T_LEFT]:
        stop = W[T]
        level = SMOOTH
        for k in range(I[N_REPLAYED]):
            row = I[I[L_REPLAYED] + k]
            number = I[row + BREAK]
            while I[row + NEEDED] and number < I[row + HEAD]:
                at = I[row + DELAY] + (number % I[row + CAPACITY]) * D_SIZE
                leaves = W[at + D_T] + W[I[row + P]]
                if leaves > latest:
                    break
                if W[at + D_LEVEL] < SMOOTH:
                    stop = max(stop, leaves)
                    level = min(level, int(W[at + D_LEVEL]))
                number += 1
        W[T_LEFT] = W[T_STOP] = stop
        I[SMOOTH_STOP] = level > KINK


@njit(cache=True, error_model="numpy", inner=True)
def latest_end(I, W, row, latest):  # type: ignore[no-untyped-def]
    """Return where the next step must end, ``latest`` or earlier, for the breakpoints that leave one dead time.

    Jumps become stops at once.
    """
    number = I[row + BREAK]
    while number < I[row + HEAD]:
        at = I[row + DELAY] + (number % I[row + CAPACITY]) * D_SIZE
        leaves = W[at + D_T] + W[I[row + P]]
        if leaves > latest or leaves > W[T_STOP]:
            break
        level = int(W[at + D_LEVEL])
        if level == 0:
            stop_at(I, W, leaves)
            break
        if level < SMOOTH:
            latest = min(latest, leaves + unseen(I, W, level))
        number += 1
    return latest


@njit(cache=True, error_model="numpy")
def unseen(I, W, level):  # type: ignore[no-untyped-def]
    """Return how far [s] behind a breakpoint of this level a step may end; infinite for those not to be noticed."""
    order = ORDERS[I[METHOD]]
    share = (FACTORIALS[level + 1] * W[RTOL]) ** (1.0 / (level + 1.0))
    own = (FACTORIALS[int(order)] * W[RTOL]) ** (1.0 / order)
    if share >= own:
        return np.inf
    return max(0.0, min(W[STEP], W[MAX_STEP])) * share / own
