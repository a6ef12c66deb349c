"""The main loop of one component: advance from where it stands to ``t_end``, writing log rows on the way.

Everything it needs to go on later is in ``I`` and ``W``; it returns a ``Status`` code.
"""

import numpy as np
from stickslip.engine.crossing import crossing_ahead
from stickslip.engine.dense import interpolate
from stickslip.engine.events import begin_instant, fire_waiting, keep_inputs, next_stop, settle
from stickslip.engine.floats import copy, finite
from stickslip.engine.layout import (
    CHAIN,
    CROWDED,
    EV_COUNT,
    EV_ROOM,
    EVENTS,
    EVENTS_SEEN,
    FRESH,
    HAS_DELAYS,
    HOLD,
    JAC_VALID,
    K1_VALID,
    LINKED,
    MAX_CHAIN,
    MAX_STEPS,
    METHOD,
    N_CHECKED,
    N_EVENTS,
    N_SAMPLED,
    N_STATES,
    N_TIMES,
    N_TURNS,
    NEXT_ROW,
    O_F,
    O_G,
    O_G0,
    O_K,
    O_S,
    O_X,
    O_Y0,
    O_Y1,
    P_RATES,
    PAUSE_AT,
    RATES_NOW,
    RHS,
    ROW,
    SMOOTH_STOP,
    STEP,
    STEPS,
    T_LEFT,
    T_STOP,
    T,
)
from stickslip.engine.pace import APART, first_step, restart, watch_stiffness
from stickslip.engine.record import arrive, limit_by_delays, store_delays
from stickslip.engine.rows import write_rows_inside, write_rows_now
from stickslip.engine.sampling import publish, turn_tables
from stickslip.engine.step import prepare_dense, step
from stickslip.engine.sweep import clock, evaluate_events, play, rates, resolution, signals
from stickslip.engine.turns import take_turns
from stickslip.logs.compiled import njit

OK, PAUSED, DELAY_FULL, STEP_TOO_SMALL, NOT_FINITE, CHATTERING, TOO_MANY_STEPS = 0, 1, 2, 3, 4, 5, 6


@njit(cache=True, nogil=True, error_model="numpy")
def advance(I, W, EV, room, times, n_times, log, t_end, last):  # type: ignore[no-untyped-def]
    """Integrate to ``t_end``; write the ``log`` at its ``times``; rows at ``t_end`` only if ``last``.

    Resumable: call again with a later ``t_end``, or, when it has paused, after emptying the event buffer
    ``EV``.  Arrays come as pointers (``entry.advance_to``): handing an array on counts its references each time.
    """
    I[N_TIMES], I[EV_ROOM] = n_times, room
    n = I[N_STATES]
    while True:
        current = I[FRESH] != 0  # after an instant signals and event functions are those of the present
        if current:
            copy(W, I[O_Y0], I[O_X], n)
            if I[HOLD] and W[T] >= t_end - clock(W):
                return OK
            status = renew(I, W, EV)
            if status != OK:
                return status
        arrived = W[T] >= t_end - clock(W)
        if last or not arrived:
            write_rows_now(I, W, times, log, current)
        if arrived:
            copy(W, I[O_Y0], I[O_X], n)
            return OK
        most = room - I[MAX_CHAIN] - 2 * I[N_EVENTS] - 8  # but for what one instant may write
        if I[EV_COUNT] >= most or I[STEPS] >= I[PAUSE_AT]:
            return PAUSED
        next_stop(I, W, t_end)
        if I[HAS_DELAYS]:
            limit_by_delays(I, W)
        W[T_LEFT] = np.nextafter(W[T_LEFT], -np.inf)
        if not I[K1_VALID] and not look(I, W):
            return NOT_FINITE
        if W[STEP] <= 0.0:
            W[STEP] = first_step(I, W) if n > 0 else np.inf
        t, left = W[T], W[T_STOP] - W[T]
        W[NEXT_ROW] = times[I[ROW]] if I[ROW] < I[N_TIMES] else np.inf
        h, limited = step(I, W)
        if h <= 0.0:
            return STEP_TOO_SMALL if h == 0.0 else NOT_FINITE
        t_new = W[T_STOP] if h == left else t + h
        dense = I[N_EVENTS] > 0 or I[HAS_DELAYS] or W[NEXT_ROW] < t_new
        if dense:
            prepare_dense(I, W, t, h)
        crossing = 2.0
        if I[N_EVENTS] > 0:
            crossing = crossing_ahead(I, W, t, h)
            if crossing < 0.0:
                continue
        I[JAC_VALID] = 0
        h_used = h
        if crossing <= 1.0:
            h_used = crossing * h
            t_new = t + h_used
            if W[T_STOP] - t_new <= resolution(t_new):
                t_new = W[T_STOP]
        if I[HAS_DELAYS] and h_used > 0.0 and not store_delays(I, W, t, h, min(1.0, crossing)):
            return DELAY_FULL
        if dense:
            write_rows_inside(I, W, times, log, t, h, t_new - resolution(t_new), min(1.0, crossing))
        if h_used > APART:
            I[CHAIN] = 0
        # over a long stiff step the states leave an instant with other slopes than the rates that events are given
        I[CROWDED] = I[METHOD] == 1 and crossing <= 1.0 and h_used <= APART
        W[T] = t_new
        if I[HAS_DELAYS]:
            arrive(I, W)
        if crossing <= 1.0:
            if not land_on_event(I, W, EV, crossing, h):
                return CHATTERING
        else:
            go_on(I, W, h == left)
            watch_stiffness(I, W, limited)
        if I[STEPS] >= I[MAX_STEPS]:
            return TOO_MANY_STEPS


@njit(cache=True, error_model="numpy", inner=True)
def renew(I, W, EV):  # type: ignore[no-untyped-def]
    """Carry out everything that happens at the present instant: samples, transitions, another pace; return a status."""
    n = I[N_STATES]
    if I[FRESH] == 1:
        begin_instant(I, W)
        copy(W, I[O_Y0], I[O_X], n)
        if I[N_SAMPLED] > 0:
            turn_tables(I, W)
            publish(I, W)
    begins = I[EVENTS_SEEN] < 0
    if (begins or I[N_TURNS] > 0) and not take_turns(I, W, EV, begins):
        return CHATTERING
    if begins:  # nothing went before the first instant, so nothing can have jumped
        keep_inputs(I, W)
    if not settle(I, W, EV):
        return CHATTERING
    copy(W, I[O_X], I[O_Y0], n)
    I[FRESH] = 0
    I[K1_VALID] = 0
    if I[EVENTS] != I[EVENTS_SEEN]:
        restart(I, W)
    return OK if finite(W, I[O_S], I[N_CHECKED]) else NOT_FINITE


@njit(cache=True, error_model="numpy")
def look(I, W):  # type: ignore[no-untyped-def]
    """Take rates and event functions at the start of a stretch; return whether the rates are finite.

    It follows ``renew``, which has left signals and event functions, and the rates where event functions look at them.
    But what is read from other cells may have been replaced since.
    """
    n = I[N_STATES]
    copy(W, I[O_Y0], I[O_X], n)
    if I[LINKED]:
        rates(I, W, W[T])
    elif not I[RATES_NOW]:
        play(I, W, W[T], P_RATES)
        I[RHS] += 1
    copy(W, I[O_F], I[O_K], n)
    if not finite(W, I[O_F], n):
        return False
    if I[LINKED] and I[N_EVENTS] > 0:
        evaluate_events(I, W, W[T])
    copy(W, I[O_G], I[O_G0], I[N_EVENTS])
    I[K1_VALID] = 1
    return True


@njit(cache=True, error_model="numpy", inner=True)
def land_on_event(I, W, EV, crossing, h):  # type: ignore[no-untyped-def]
    """End the step at the event found in it and let it happen; return False if too many follow each other."""
    interpolate(I, W, crossing)
    evaluate_events(I, W, W[T])
    begin_instant(I, W)
    fire_waiting(I, W, EV)
    if I[CHAIN] > I[MAX_CHAIN]:
        return False
    copy(W, I[O_X], I[O_Y0], I[N_STATES])
    I[FRESH] = 1
    return True


@njit(cache=True, error_model="numpy")
def go_on(I, W, stopped):  # type: ignore[no-untyped-def]
    """Take the end of the step as the present; if it ``stopped`` there, something happens at this instant."""
    n = I[N_STATES]
    copy(W, I[O_Y1], I[O_Y0], n)
    copy(W, I[O_Y1], I[O_X], n)
    copy(W, I[O_Y1] + n, I[O_K], n)
    copy(W, I[O_G] + I[N_EVENTS], I[O_G0], I[N_EVENTS])
    if stopped and not I[SMOOTH_STOP]:
        if I[RATES_NOW]:
            signals(I, W, W[T])  # the left limit, from which settle sees jumps
        I[FRESH] = 1
