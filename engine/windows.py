"""Many cells, each with its own step, joined by smooth signals: waveform relaxation in windows of time.

With one step size for a whole diagram every event of one loop shortens the steps of all others.  So a large component
is cut where signals are smooth, at the outputs of integrators, into cells.  A cell runs alone over a window of time
while what it reads from other cells is replayed from records; then its own outputs are compared with what the others
have read, and those that have read something else run again, until nobody has.  What is far away in the diagram hardly
changes, so most cells run twice, and an event costs its own cell and its neighbours something, and the rest nothing.

The window follows how fast this converges (Lelarasmee, Ruehli & Sangiovanni-Vincentelli 1982; the error after k runs is
of the order (L h)^k/k! in a window h with coupling L).  The records are those of ``delay``: a link is a dead time of
length zero from one cell to another.
"""

import numpy as np
from stickslip.engine.advance import OK, PAUSED
from stickslip.engine.call import pointer_to
from stickslip.engine.delay import SMOOTH, delayed
from stickslip.engine.entry import advance_to
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    ATOL,
    BREAK,
    COUNT,
    D_H,
    D_LEVEL,
    D_NODES,
    D_SIZE,
    D_T,
    D_V,
    DELAY,
    EV_COUNT,
    EVENTS,
    HEAD,
    JACOBIANS,
    KIND,
    LINK_IN,
    LINK_OUT,
    N_BLOCKS,
    N_STATES,
    O_S,
    O_X,
    O_Y0,
    PAUSE_AT,
    REJECTED,
    RHS,
    RTOL,
    SAVED,
    STEPS,
    TABLE,
    TAIL,
    TAKES,
    WIRES,
    H,
    R,
    T,
)
from stickslip.engine.sweep import signals
from stickslip.logs.compiled import njit

TIGHT = 7  # the cells hang together too tightly for windows
MOST_RUNS = 10  # of one cell in one window
FEW, LONGER, ENOUGH, SHORTER = (
    3,
    1.4,
    4,
    0.7,
)  # after few runs the next window is longer, after more than enough shorter
CLOSE = 0.1  # share of the tolerance by which a signal may differ from what its readers have read
KINK = 1  # what is smoother is left to the step size control of the reader
ROUND = 1000  # runs of cells after which the host may look up
SHORTEST = 1e-9  # a window of this share of the run is none
ENOUGH_SEEN = 100  # windows after which it is judged whether they pay: an event or a sample in one component costs
DEAREST = 2  # about as many steps of all cells as this number of windows

# columns of ``cells``: where each cell begins in ``ints``, ``floats`` and the rows of the log, and where its links out
# begin in ``links``; one row more than there are cells
CELL_I, CELL_W, CELL_LOG, CELL_LINKS = 0, 1, 2, 3
# columns of ``links``, in the order of the cells that they leave: row that records, cell and row that replay
LINK_FROM, LINK_TO, LINK_ROW = 0, 1, 2
WINDOW, DONE = 0, 1  # ``state``: length of the next window [s], windows done


@njit(cache=True, error_model="numpy")
def predict(W, I, row, t, h, value, slope):  # type: ignore[no-untyped-def]
    """Let a link replay a straight line over the window."""
    at = I[row + DELAY]
    W[at + D_T], W[at + D_H], W[at + D_LEVEL] = t, h, SMOOTH
    for m in range(D_NODES):
        W[at + D_V + m] = value + slope * h * m / (D_NODES - 1.0)
    I[row + TAIL] = I[row + BREAK] = 0
    I[row + HEAD] = 1


@njit(cache=True, error_model="numpy")
def differs(I, W, row, I2, W2, row2):  # type: ignore[no-untyped-def]
    """Return whether what ``row`` has recorded is not what ``row2`` of another cell has replayed."""
    for number in range(I[row + HEAD]):
        at = I[row + DELAY] + number * D_SIZE
        for m in (3, D_NODES - 1):
            value = W[at + D_V + m]
            other = delayed(I2, W2, row2, W[at + D_T] + W[at + D_H] * m / (D_NODES - 1.0))
            if not abs(value - other) <= CLOSE * (W[ATOL] + W[RTOL] * abs(value)):
                return True
    return False


@njit(cache=True, error_model="numpy", inner=True)
def hand_over(I, W, row, I2, W2, row2):  # type: ignore[no-untyped-def]
    """Let ``row2`` of another cell replay what ``row`` has recorded."""
    count = I[row + HEAD]
    start, to = I[row + DELAY], I2[row2 + DELAY]
    for m in range(count * D_SIZE):
        W2[to + m] = W[start + m]
    for number in range(count):
        if W2[to + number * D_SIZE + D_LEVEL] > KINK:
            W2[to + number * D_SIZE + D_LEVEL] = SMOOTH
    I2[row2 + TAIL] = I2[row2 + BREAK] = 0
    I2[row2 + HEAD] = count


@njit(cache=True, error_model="numpy", inner=True)
def last_line(I, W, row):  # type: ignore[no-untyped-def]
    """Return value and slope at the end of what a link has recorded."""
    at = I[row + DELAY] + (I[row + HEAD] - 1) * D_SIZE
    last, before = W[at + D_V + D_NODES - 1], W[at + D_V + D_NODES - 2]
    return last, (last - before) * (D_NODES - 1.0) / W[at + D_H] if W[at + D_H] > 1e-6 else 0.0


@njit(cache=True, error_model="numpy", inner=True)
def copy_back(source, target, start, count):  # type: ignore[no-untyped-def]
    """Copy a stretch between two arrays of the same form."""
    for i in range(start, start + count):
        target[i] = source[i]


@njit(cache=True, error_model="numpy", inner=True)
def set_back(ints, floats, saved_I, saved_W, cells, c):  # type: ignore[no-untyped-def]
    """Set a cell back to the beginning of the window, but for what it has cost and what its links replay."""
    i, w = cells[c, CELL_I], cells[c, CELL_W]
    rhs, jacobians = ints[i + RHS], ints[i + JACOBIANS]
    rejected = ints[i + REJECTED] + ints[i + STEPS] - saved_I[i + STEPS]
    for b in range(ints[i + N_BLOCKS]):
        row = i + H + b * R
        if ints[row + KIND] == LINK_IN:
            saved_I[row + HEAD] = ints[row + HEAD]
            saved_I[row + TAIL] = saved_I[row + BREAK] = 0
    copy_back(saved_I, ints, i, H + ints[i + N_BLOCKS] * R)
    copy_back(saved_W, floats, w, ints[i + SAVED])
    ints[i + RHS], ints[i + JACOBIANS], ints[i + REJECTED] = rhs, jacobians, rejected


@njit(cache=True, error_model="numpy", inner=True)
def run_cell(ints, floats, cells, c, EV, times, log, t_end, last):  # type: ignore[no-untyped-def]
    """Advance one cell over the window, its links out written anew; return a status."""
    i, w, first = cells[c, CELL_I], cells[c, CELL_W], cells[c, CELL_LOG]
    for b in range(ints[i + N_BLOCKS]):
        row = i + H + b * R
        if ints[row + KIND] == LINK_OUT:
            ints[row + HEAD] = ints[row + TAIL] = ints[row + BREAK] = 0
    ints[i + PAUSE_AT] = np.iinfo(np.int64).max
    rows = log[first : cells[c + 1, CELL_LOG]]
    status = advance_to(ints[i : cells[c + 1, CELL_I]], floats[w : cells[c + 1, CELL_W]], EV, times, rows, t_end, last)
    return TIGHT if status == PAUSED else status  # more events than there is room for


@njit(cache=True, error_model="numpy")
def instants(ints, cells):  # type: ignore[no-untyped-def]
    """Return how many events and samples all cells have had."""
    total = 0
    for c in range(cells.shape[0] - 1):
        i = cells[c, CELL_I]
        total += ints[i + EVENTS]
        for b in range(ints[i + N_BLOCKS]):
            row = i + H + b * R
            if ints[row + TAKES] or ints[row + TABLE] != 0:
                total += ints[row + COUNT]
    return total


@njit(cache=True, error_model="numpy")
def look_around(ints, floats, cells, links, lines):  # type: ignore[no-untyped-def]
    """Write the present values of what the links hand over to ``lines``; they follow from the states alone."""
    for c in range(cells.shape[0] - 1):
        I, W = pointer_to(ints[cells[c, CELL_I] :]), pointer_to(floats[cells[c, CELL_W] :])
        if cells[c, CELL_LINKS] < cells[c + 1, CELL_LINKS]:
            copy(W, I[O_Y0], I[O_X], I[N_STATES])
            signals(I, W, W[T])
        for k in range(cells[c, CELL_LINKS], cells[c + 1, CELL_LINKS]):
            lines[k, 0], lines[k, 1] = W[I[O_S] + I[I[links[k, LINK_FROM] + WIRES]]], 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def advance_windows(ints, floats, cells, links, lines, state, EV, events, times, log, t_end):  # type: ignore[no-untyped-def]
    """Advance all cells together to ``t_end``; return (status, events written).

    ``lines`` (links, 2): value and slope at the present; ``EV``: room for the events of one cell in one window;
    ``events``: those of the windows done.  Resumable like ``advance.advance``.
    """
    n = cells.shape[0] - 1
    written, runs = 0, 0
    begin = floats[cells[0, CELL_W] + T]
    shortest = (t_end - begin) * SHORTEST
    saved_I, saved_W = np.empty_like(ints), np.empty_like(floats)
    waiting = np.empty(n, dtype=np.bool_)
    while True:
        t = floats[T]
        if runs > ROUND or written + n * EV.shape[1] > events.shape[0]:
            return PAUSED, written
        t_new = t + state[WINDOW]
        if t_new > t_end - 1e-3 * state[WINDOW]:
            t_new = t_end
        for c in range(n):
            i, w = cells[c, CELL_I], cells[c, CELL_W]
            copy_back(ints, saved_I, i, H + ints[i + N_BLOCKS] * R)
            copy_back(floats, saved_W, w, ints[i + SAVED])
            waiting[c] = True
            for k in range(cells[c, CELL_LINKS], cells[c + 1, CELL_LINKS]):
                to = links[k, LINK_TO]
                I2 = pointer_to(ints[cells[to, CELL_I] :])
                W2 = pointer_to(floats[cells[to, CELL_W] :])
                predict(W2, I2, links[k, LINK_ROW], t, t_new - t, lines[k, 0], lines[k, 1])
        status, sweeps, left = OK, 0, n
        while left > 0 and status == OK:
            sweeps += 1
            if sweeps > MOST_RUNS:
                status = TIGHT
            for place in range(n):
                c = place if sweeps % 2 == 0 else n - 1 - place  # there and back: neighbours often stand side by side
                if not waiting[c] or status != OK:
                    continue
                waiting[c] = False
                left -= 1
                runs += 1
                if sweeps > 1:
                    set_back(ints, floats, saved_I, saved_W, cells, c)
                status = run_cell(ints, floats, cells, c, EV[c], times, log, t_new, t_new == t_end)
                if status != OK:
                    break
                I, W = pointer_to(ints[cells[c, CELL_I] :]), pointer_to(floats[cells[c, CELL_W] :])
                for k in range(cells[c, CELL_LINKS], cells[c + 1, CELL_LINKS]):
                    to, row, row2 = links[k, LINK_TO], links[k, LINK_FROM], links[k, LINK_ROW]
                    I2, W2 = pointer_to(ints[cells[to, CELL_I] :]), pointer_to(floats[cells[to, CELL_W] :])
                    if differs(I, W, row, I2, W2, row2):
                        hand_over(I, W, row, I2, W2, row2)
                        if not waiting[to]:
                            waiting[to] = True
                            left += 1
        if status != OK:
            for c in range(n):
                set_back(ints, floats, saved_I, saved_W, cells, c)
            state[WINDOW] = 0.5 * (t_new - t)
            if state[WINDOW] < shortest:
                return status, written
            continue
        for c in range(n):
            i = cells[c, CELL_I]
            for e in range(ints[i + EV_COUNT]):
                events[written] = EV[c, e]
                written += 1
            ints[i + EV_COUNT] = 0
            I, W = pointer_to(ints[i:]), pointer_to(floats[cells[c, CELL_W] :])
            for k in range(cells[c, CELL_LINKS], cells[c + 1, CELL_LINKS]):
                lines[k, 0], lines[k, 1] = last_line(I, W, links[k, LINK_FROM])
        state[DONE] += 1.0
        if state[DONE] % ENOUGH_SEEN == 0.0 and state[DONE] > ENOUGH_SEEN + DEAREST * instants(ints, cells):
            return TIGHT, written
        if t_new == t_end:
            return OK, written
        if sweeps <= FEW:
            state[WINDOW] *= LONGER
        elif sweeps > ENOUGH:
            state[WINDOW] *= SHORTER
