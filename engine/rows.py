"""Log rows: dense output at the log times, a chunk of rows at a time, block by block."""

from stickslip.engine.call import call
from stickslip.engine.delay import delayed
from stickslip.engine.dense import interpolate_rows
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    A_OUT,
    AFFINE,
    CHUNK,
    DEAD_TIME,
    GATHER,
    KIND,
    L_WIRES,
    LINK_IN,
    METHOD,
    N_BLOCKS,
    N_LOG,
    N_SIGNALS,
    N_STATES,
    N_TIMES,
    NU,
    NY,
    O_CS,
    O_CX,
    O_S,
    O_X,
    O_Y0,
    ROW,
    STILL,
    WIRES,
    D,
    H,
    P,
    R,
    T,
    U,
    X,
    Y,
)
from stickslip.engine.series_rows import series_rows
from stickslip.engine.sweep import clock, signals
from stickslip.logs.compiled import njit

MANY = 4  # rows in a step of a series, from which it pays to make series of the signals too


@njit(cache=True, error_model="numpy", inner=True)
def write_rows_now(I, W, times, log, current):  # type: ignore[no-untyped-def]
    """Write the log rows that are due at the present; ``current``: the signals are those of the present."""
    present = W[T] + clock(W)
    if I[ROW] >= I[N_TIMES] or times[I[ROW]] > present:
        return
    if not current:
        copy(W, I[O_Y0], I[O_X], I[N_STATES])
        signals(I, W, W[T])
    wires = I[L_WIRES]
    while I[ROW] < I[N_TIMES] and times[I[ROW]] <= present:
        for i in range(I[N_LOG]):
            log[i * I[N_TIMES] + I[ROW]] = W[I[O_S] + I[wires + i]]
        I[ROW] += 1


@njit(cache=True, error_model="numpy", inner=True)
def write_rows_inside(I, W, times, log, t, h, t_new, share):  # type: ignore[no-untyped-def]
    """Write the log rows strictly before ``t_new`` from the dense output of the step that began at ``t``.

    Up to the ``share`` of the step no event fires.
    """
    if I[METHOD] == 3 and I[AFFINE]:
        last = I[ROW] + MANY - 1
        if last < I[N_TIMES] and times[last] < t_new and series_rows(I, W, times, log, t, h, t_new, share):
            return
    ns, cs = I[N_SIGNALS], I[O_CS]
    wires = I[L_WIRES]
    while True:
        first = I[ROW]
        count = 0
        while count < CHUNK and first + count < I[N_TIMES] and times[first + count] < t_new:
            count += 1
        if count == 0:
            return
        interpolate_rows(I, W, times, first, count, t, h)
        for b in range(I[N_BLOCKS]):  # a reader may stand before a sampled block, whose output it reads all the same
            if I[H + b * R + STILL]:
                _hold_signals(I, W, H + b * R, count)
        for b in range(I[N_BLOCKS]):
            if not I[H + b * R + STILL]:
                _chunk_signals(I, W, H + b * R, times, first, count)
        for i in range(I[N_LOG]):
            signal = cs + I[wires + i]
            for r in range(count):
                log[i * I[N_TIMES] + first + r] = W[signal + r * ns]
        I[ROW] = first + count


@njit(cache=True, error_model="numpy", inner=True)
def _hold_signals(I, W, row, count):  # type: ignore[no-untyped-def]
    """Repeat the outputs of a block that stands still between two instants in all rows of the chunk."""
    ns, first, cs = I[N_SIGNALS], I[row + Y], I[O_CS]
    for r in range(count):
        for j in range(I[row + NY]):
            W[cs + r * ns + first + j] = W[I[O_S] + first + j]


@njit(cache=True, error_model="numpy", inner=True)
def _chunk_signals(I, W, row, times, first, count):  # type: ignore[no-untyped-def]
    """Compute one moving block's outputs for all rows of the chunk."""
    n, ns = I[N_STATES], I[N_SIGNALS]
    cx, cs = I[O_CX] + I[row + X], I[O_CS]
    where, d, p, y, u = I[row + A_OUT], I[row + D], I[row + P], I[row + Y], I[row + U]
    wires, gathered = I[row + WIRES], I[row + GATHER]
    direct = gathered == 0 and I[row + NU] == 1
    if I[row + KIND] == DEAD_TIME or I[row + KIND] == LINK_IN:
        for r in range(count):
            W[cs + r * ns + y] = delayed(I, W, row, times[first + r])
        return
    for r in range(count):
        base = cs + r * ns
        for i in range(gathered):
            W[u + i] = W[base + I[wires + i]]
        inputs = base + I[wires] if direct else u
        call(where, times[first + r], W, cx + r * n, d, inputs, p, base + y)
