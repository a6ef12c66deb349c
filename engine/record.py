"""What enters the dead times during a step: written behind it, and not stepped over when it comes out.

``delay`` keeps and reads the records; here the states between the ends of a step are turned into signals.
"""

from numba import njit

from engine.delay import next_break, open_record
from engine.dense import interpolate
from engine.events import stop_at
from engine.layout import (
    CAPACITY,
    D_NODES,
    D_SIZE,
    D_V,
    DEAD_TIME,
    DELAY,
    HEAD,
    KIND,
    MAX_STEP,
    N_BLOCKS,
    O_S,
    PENDING_LEVEL,
    WIRES,
    H,
    P,
    R,
    T,
)
from engine.sweep import signals


@njit(cache=True, error_model="numpy")
def store_delays(I, W, t, h, part):  # type: ignore[no-untyped-def]
    """Record what enters each dead time during the used part of the step; return False if a ring is full."""
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == DEAD_TIME and open_record(I, W, row, t, part * h, I[PENDING_LEVEL]) < 0:
            return False
    for m in range(D_NODES):
        s = m / (D_NODES - 1.0) * part
        interpolate(I, W, s)
        signals(I, W, t + s * h)
        for b in range(I[N_BLOCKS]):
            row = H + b * R
            if I[row + KIND] == DEAD_TIME:
                last = I[row + HEAD] - 1
                at = I[row + DELAY] + (last % I[row + CAPACITY]) * D_SIZE + D_V
                W[at + m] = W[I[O_S] + I[I[row + WIRES]]]
    return True


@njit(cache=True, error_model="numpy")
def limit_by_delays(I, W):  # type: ignore[no-untyped-def]
    """Stop at breakpoints leaving a dead time, and never step further than the shortest dead time."""
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == DEAD_TIME:
            at, level = next_break(I, W, row, W[T])
            stop_at(I, W, at, int(level))
            W[MAX_STEP] = min(W[MAX_STEP], W[I[row + P]])
