"""Sampled blocks: when each is due, and what happens at a sampling instant."""

import numpy as np
from stickslip.engine.call import call
from stickslip.engine.delay import happens, let_out
from stickslip.engine.layout import (
    A_STEP,
    COUNT,
    EVENTS_SEEN,
    FEEDS,
    KIND,
    L_INSTANTS,
    L_REPLAYED,
    N_BLOCKS,
    N_INSTANTS,
    N_REPLAYED,
    ND,
    O_S,
    O_SCRATCH,
    O_X,
    OFFSET,
    PERIOD,
    SAMPLED,
    SEEN,
    TABLE,
    TAKES,
    D,
    H,
    P,
    R,
    T,
    U,
    X,
    Y,
)
from stickslip.engine.listed import find_row, listed_time, put_row
from stickslip.engine.sweep import clock, gather
from stickslip.logs.compiled import njit


@njit(cache=True, error_model="numpy", inner=True)
def turn_tables(I, W):  # type: ignore[no-untyped-def]
    """Put the rows of the timetables that are due now in force, but for blocks that take samples then."""
    now = W[T] + clock(W)
    for k in range(I[N_INSTANTS]):
        row = I[I[L_INSTANTS] + k]
        if I[row + TABLE] != 0 and not I[row + TAKES]:
            while listed_time(I, row) <= now:
                put_row(I, W, row, I[row + COUNT])
                I[row + COUNT] += 1
                happens(I, row, 0)


@njit(cache=True, error_model="numpy")
def publish(I, W):  # type: ignore[no-untyped-def]
    """Let the sampled blocks that are due and need no input for it write their outputs, memories untouched."""
    now = W[T] + clock(W)
    for k in range(I[N_INSTANTS]):
        row = I[I[L_INSTANTS] + k]
        if I[row + KIND] == SAMPLED and not I[row + FEEDS] and due(I, W, row) <= now:
            for i in range(I[row + ND]):
                W[I[O_SCRATCH] + i] = W[I[row + D] + i]
            run_step(I, W, row)
            for i in range(I[row + ND]):
                W[I[row + D] + i] = W[I[O_SCRATCH] + i]


@njit(cache=True, error_model="numpy")
def take(I, W, row):  # type: ignore[no-untyped-def]
    """Take the sample of one block; what it reads must be current."""
    if I[row + TABLE] != 0:
        put_row(I, W, row, I[row + COUNT])
    run_step(I, W, row)
    I[row + COUNT] += 1


@njit(cache=True, error_model="numpy")
def due(I, W, row):  # type: ignore[no-untyped-def]
    """Return the next sampling instant of a block, listed or counted, so that rounding cannot drift."""
    if I[row + TABLE] != 0:
        return listed_time(I, row)
    return W[I[row + OFFSET]] + I[row + COUNT] * W[I[row + PERIOD]]


@njit(cache=True, error_model="numpy", inner=True)
def run_step(I, W, row):  # type: ignore[no-untyped-def]
    """Take one sample of one block: new memory, new held outputs."""
    happens(I, row, 0)
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


@njit(cache=True, error_model="numpy", inner=True)
def begin_run(I, W):  # type: ignore[no-untyped-def]
    """Count the samples that lie before the start, or at it if the run continues one that has taken them.

    So are the breakpoints that a continued run has let out of its dead times.  A block that joins such a run has no
    sample at first (COUNT below zero) and takes the one at the start.  Of a timetable the last row before the start is
    in force, the first if there is none.
    """
    for k in range(I[N_REPLAYED]):
        let_out(I, W, I[I[L_REPLAYED] + k], W[T] + clock(W))
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        joins = I[row + COUNT] < 0
        if I[row + TABLE] != 0:
            find_row(I, W, row, W[T] - clock(W))
        elif I[row + KIND] == SAMPLED:
            I[row + COUNT] = max(0, int(np.ceil((W[T] - W[I[row + OFFSET]]) / W[I[row + PERIOD]] - 1e-9)))
        if I[row + TAKES] and not joins and due(I, W, row) <= W[SEEN] + clock(W):
            I[row + COUNT] += 1
    I[EVENTS_SEEN] = -2
