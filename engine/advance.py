"""The main loop of one component: advance from where it stands to ``t_end``, writing log rows on the way.

Everything it needs to go on later is in ``I`` and ``W``; it returns a ``Status`` code.
"""

import numpy as np
from numba import njit

from engine.call import pointer_to
from engine.crossing import first_crossing
from engine.delay import next_break, open_record
from engine.dense import interpolate
from engine.events import begin_instant, fire_positive, next_stop, settle, stop_at
from engine.explicit import STIFF_RATIO, explicit_dense, explicit_step
from engine.high_order import HIGH_STIFF_RATIO, high_order_dense, high_order_step
from engine.jacobian import jacobian
from engine.layout import (
    ATOL,
    CAPACITY,
    CHAIN,
    CLOSER,
    CROWDED,
    D_NODES,
    D_SIZE,
    D_V,
    DEAD_TIME,
    DELAY,
    DENSE_TERMS,
    EV_COUNT,
    EVENTS,
    EVENTS_SEEN,
    EXPLICIT,
    FRESH,
    HAS_DELAYS,
    HAS_RATES,
    HEAD,
    HOLD,
    K1_VALID,
    KIND,
    LEARN,
    LOGGED,
    MAX_CHAIN,
    MAX_STEP,
    MAX_STEPS,
    METHOD,
    METHOD_WISH,
    N_BLOCKS,
    N_CHECKED,
    N_EVENTS,
    N_SAMPLED,
    N_STATES,
    O_F,
    O_G,
    O_G0,
    O_K,
    O_RESTART,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    PENDING_LEVEL,
    REJECTED,
    RESTARTS,
    ROW,
    RTOL,
    STEP,
    STEPS,
    STIFF_COUNT,
    STOP_LEVEL,
    T_LEFT,
    T_STOP,
    WIRES,
    D,
    H,
    P,
    R,
    T,
)
from engine.rosenbrock import rosenbrock_dense, rosenbrock_step
from engine.rows import write_row, write_rows_inside
from engine.sampling import sample
from engine.sweep import clock, evaluate_events, finite, rates, resolution, signals

OK, EVENTS_FULL, DELAY_FULL, STEP_TOO_SMALL, NOT_FINITE, CHATTERING, TOO_MANY_STEPS = 0, 1, 2, 3, 4, 5, 6
STIFF_STEPS = 12  # steps in a row at the stability limit before the stiff method takes over
SMOOTH = 9
APART = 1e-6  # transitions that follow each other faster than this [s] count as one chain
MOST_CLOSER = 3  # a stiff step is shortened so many times to end just behind an event, where its states are best:
COARSE = 1e-3  # an event is first located to this share of the step,
BEHIND = 1.003  # the next try ends a little behind it,
END = 0.99  # and is taken if the event lies behind this share of it


@njit(cache=True, error_model="numpy")
def copy(W, source, target, n):  # type: ignore[no-untyped-def]
    """Copy ``n`` floats inside ``W``."""
    for i in range(n):
        W[target + i] = W[source + i]


@njit(cache=True, error_model="numpy")
def mode_slot(I, W):  # type: ignore[no-untyped-def]
    """Return where the first step after an event into the present combination of modes is remembered."""
    key = 0
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + LOGGED]:
            key = (7 * key + int(W[I[row + D]]) + 64) % RESTARTS
    return key


@njit(cache=True, error_model="numpy")
def first_step(I, W):  # type: ignore[no-untyped-def]
    """Propose a first step from the size of the state, its rate and one probing Euler step."""
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


@njit(cache=True, nogil=True, error_model="numpy")
def advance(ints, floats, EV, times, log, t_end, last):  # type: ignore[no-untyped-def]
    """Integrate to ``t_end``; write rows of ``log`` at ``times``; rows at ``t_end`` itself only if ``last``.

    Resumable: call again with a later ``t_end`` (or after emptying the event buffer ``EV``).
    """
    I, W = pointer_to(ints), pointer_to(floats)
    n = I[N_STATES]
    y0, y1, k, f, x = I[O_Y0], I[O_Y1], I[O_K], I[O_F], I[O_X]
    rejected_before = have_jacobian = False
    while True:
        # --- the present instant ----------------------------------------------------------------------
        if I[FRESH]:
            copy(W, y0, x, n)
            if I[HOLD] and W[T] >= t_end - clock(W):
                return OK
            if I[FRESH] == 1:
                begin_instant(I, W)
                copy(W, y0, x, n)
                if I[N_SAMPLED] > 0:
                    sample(I, W)
            if I[EVENTS_SEEN] < 0:  # nothing went before the first instant, so nothing can have jumped
                signals(I, W, W[T])
                begin_instant(I, W)
            if not settle(I, W, EV, min(1.0, max(W[STEP], 1e-9))):
                return CHATTERING
            copy(W, x, y0, n)
            I[FRESH] = 0
            I[K1_VALID] = 0
            if I[EVENTS] != I[EVENTS_SEEN]:  # another mode: other steps, and stiff if it was so before
                slot = mode_slot(I, W)
                stiff = I[METHOD_WISH] == 2 or W[I[O_RESTART] + RESTARTS + slot] > 0.0
                I[METHOD] = 1 if stiff else I[EXPLICIT]
                I[STIFF_COUNT] = 0
                W[STEP] = W[I[O_RESTART] + slot]
                I[LEARN] = slot + 1
                I[EVENTS_SEEN] = I[EVENTS]
                if I[CROWDED]:
                    W[STEP] = min(W[STEP], APART)
                    I[LEARN] = 0
            if not finite(W, I[O_S], I[N_CHECKED]):
                return NOT_FINITE
        arrived = W[T] >= t_end - clock(W)
        present = W[T] + clock(W)
        if I[ROW] < times.shape[0] and times[I[ROW]] <= present and (last or not arrived):
            copy(W, y0, x, n)
            signals(I, W, W[T])
            while I[ROW] < times.shape[0] and times[I[ROW]] <= present:
                write_row(I, W, log, I[ROW])
                I[ROW] += 1
        if arrived:
            copy(W, y0, x, n)
            return OK
        if I[EV_COUNT] >= EV.shape[0] - I[MAX_CHAIN] - 2 * I[N_EVENTS] - 8:  # what one instant may write
            return EVENTS_FULL
        # --- what must not be stepped over -------------------------------------------------------------
        next_stop(I, W, t_end)
        if I[HAS_DELAYS]:
            limit_by_delays(I, W)
        t = W[T]
        W[T_LEFT] = np.nextafter(W[T_LEFT], -np.inf)
        if not I[K1_VALID]:
            copy(W, y0, x, n)
            rates(I, W, t)
            copy(W, f, k, n)
            if not finite(W, f, n):
                return NOT_FINITE
            if I[N_EVENTS] > 0:
                evaluate_events(I, W, t, min(1.0, max(W[STEP], 1e-9)))
                copy(W, I[O_G], I[O_G0], I[N_EVENTS])
            I[K1_VALID] = 1
        if W[STEP] <= 0.0:
            W[STEP] = first_step(I, W) if n > 0 else np.inf
        # --- one accepted step -------------------------------------------------------------------------
        while True:
            left = W[T_STOP] - t
            h = min(W[STEP], W[MAX_STEP])
            if h >= left * (1.0 - 1e-12):
                h = left
            elif h > 0.5 * left:
                h = 0.5 * left
            if I[METHOD] == 0:
                error, ratio = explicit_step(I, W, t, h)
                limit, power = STIFF_RATIO, 0.2
            elif I[METHOD] == 2:
                error, ratio = high_order_step(I, W, t, h)
                limit, power = HIGH_STIFF_RATIO, 0.125
            else:
                if not have_jacobian:
                    jacobian(I, W, t, h)
                    have_jacobian = True
                error = rosenbrock_step(I, W, t, h)
                ratio, limit, power = 0.0, 1.0, 0.2
            if error <= 1.0:
                break
            rejected_before = True
            I[REJECTED] += 1
            W[STEP] = h * max(0.1, 0.9 * error ** (-power)) if np.isfinite(error) else 0.1 * h
            if W[STEP] < clock(W):
                return STEP_TOO_SMALL if np.isfinite(error) else NOT_FINITE
        I[STEPS] += 1
        best = 0.9 * max(error, 1e-15) ** (-power)
        if I[LEARN] > 0:
            W[I[O_RESTART] + I[LEARN] - 1] = h * min(100.0, best)
            I[LEARN] = 0
        growth = min(10.0 if I[METHOD] == 2 else 5.0, max(0.2, best))
        if rejected_before:
            growth = min(growth, 1.0)
            rejected_before = False
        if h < left or growth < 1.0:
            W[STEP] = h * growth
        else:
            W[STEP] = max(W[STEP], h * growth)
        t_new = W[T_STOP] if h == left else t + h
        copy(W, f, y1 + n, n)  # rates at the end, kept over dense output and event searches
        # --- where did it lead -------------------------------------------------------------------------
        crossing = 2.0
        dense = False
        if I[N_EVENTS] > 0 or I[HAS_DELAYS] or (I[ROW] < times.shape[0] and times[I[ROW]] < t_new):
            if I[METHOD] == 0:
                explicit_dense(I, W, h)
                I[DENSE_TERMS] = 5
            elif I[METHOD] == 2:
                high_order_dense(I, W, t, h)
                I[DENSE_TERMS] = 8
            else:
                rosenbrock_dense(I, W)
                I[DENSE_TERMS] = 5
            dense = True
        if I[N_EVENTS] > 0:
            coarse = I[METHOD] == 1 and I[CLOSER] < MOST_CLOSER
            crossing = first_crossing(I, W, t, h, COARSE if coarse else 0.0)
            if coarse and crossing < END and crossing * h > 1e-6:
                W[STEP] = BEHIND * crossing * h
                I[CLOSER] += 1
                I[REJECTED] += 1
                continue
            if coarse and crossing <= 1.0:
                crossing = first_crossing(I, W, t, h, 0.0)
            I[CLOSER] = 0
        have_jacobian = False
        if crossing <= 1.0:
            h_used = crossing * h
            t_new = t + h_used
            if W[T_STOP] - t_new <= resolution(t_new):
                t_new = W[T_STOP]
        else:
            h_used = h
        if I[HAS_DELAYS] and h_used > 0.0:
            if not store_delays(I, W, t, h, min(1.0, crossing)):
                return DELAY_FULL
            I[PENDING_LEVEL] = SMOOTH
        if dense:
            write_rows_inside(I, W, times, log, t, h, t_new - resolution(t_new))
        if h_used > APART:
            I[CHAIN] = 0
        # over a long stiff step the states leave an instant with other slopes than the rates that events are told
        I[CROWDED] = I[METHOD] == 1 and crossing <= 1.0 and h_used <= APART
        if crossing <= 1.0:
            interpolate(I, W, crossing)
            W[T] = t_new
            evaluate_events(I, W, t_new, min(1.0, h))
            begin_instant(I, W)
            for i in range(I[N_EVENTS]):  # only what was waiting may fire here; the rest belongs to settle
                if W[I[O_G0] + i] > 0.0:
                    W[I[O_G] + i] = -1.0
            fire_positive(I, W, EV)
            if I[CHAIN] > I[MAX_CHAIN]:
                return CHATTERING
            copy(W, x, y0, n)
            I[FRESH] = 1
            I[PENDING_LEVEL] = 0
        else:
            copy(W, y1, y0, n)
            copy(W, y1, x, n)
            copy(W, y1 + n, k, n)
            copy(W, I[O_G] + I[N_EVENTS], I[O_G0], I[N_EVENTS])
            if h == left and I[HAS_RATES]:
                signals(I, W, t_new)  # the left limit, from which settle sees jumps
            W[T] = t_new
            if h == left:
                I[FRESH] = 1
                I[PENDING_LEVEL] = I[STOP_LEVEL]
            if I[METHOD] != 1 and I[METHOD_WISH] == 0:
                I[STIFF_COUNT] = I[STIFF_COUNT] + 1 if ratio > limit else max(0, I[STIFF_COUNT] - 2)
                if I[STIFF_COUNT] >= STIFF_STEPS:
                    I[METHOD] = 1
                    W[I[O_RESTART] + RESTARTS + mode_slot(I, W)] = 1.0
        if I[STEPS] >= I[MAX_STEPS]:
            return TOO_MANY_STEPS
