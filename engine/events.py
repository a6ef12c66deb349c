"""Events: crossings located on the dense output, transitions applied, and everything that happens at one instant.

An event function fires when it becomes positive.  A transition must leave its block's event functions at or
below zero; transitions that follow at once from others (slip, then stick) are carried out in a chain.
"""

import numpy as np
from numba import njit

from engine.call import call, pointer_to
from engine.dense import interpolate
from engine.layout import (
    A_JUMP,
    A_NEXT,
    A_STEP,
    A_ZC,
    ATOL,
    CHAIN,
    CONTINUOUS,
    COUNT,
    EV_COUNT,
    EVENTS,
    EVENTS_SEEN,
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
    RTOL,
    SAMPLED,
    SEEN,
    STOP_LEVEL,
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
from engine.sweep import clock, evaluate_events, gather, gather_with_rates, resolution, signals

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
    """Show signal jumps as impulses, at their old value, to the blocks that watch the rate of an input.

    What is far below the tolerances is rounding, for example where a breakpoint leaves a dead time, and no jump.
    """
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
                if abs(jump) <= 1e-3 * W[ATOL] + (1e-3 * W[RTOL] + 1e-14) * abs(W[s + wire]):
                    jump = 0.0
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
    publish(I, W)
    for b in range(I[N_BLOCKS]):
        take(I, W, H + b * R)


@njit(cache=True, error_model="numpy")
def publish(I, W):  # type: ignore[no-untyped-def]
    """Let the sampled blocks that are due and need no input for it write their outputs, memories untouched."""
    signals(I, W, W[T])
    now = W[T] + clock(W)
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED and not I[row + FEEDS] and due(I, W, row) <= now:
            for i in range(I[row + ND]):
                W[I[O_SCRATCH] + i] = W[I[row + D] + i]
            run_step(I, W, row)
            for i in range(I[row + ND]):
                W[I[row + D] + i] = W[I[O_SCRATCH] + i]


@njit(cache=True, error_model="numpy")
def take(I, W, row):  # type: ignore[no-untyped-def]
    """Take the sample of one block if it is due."""
    if I[row + KIND] == SAMPLED and due(I, W, row) <= W[T] + clock(W):
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
    if I[EVENTS_SEEN] == -1:
        begin_run(I, W)
    s, s0 = I[O_S], I[O_S0]
    for i in range(I[N_SIGNALS]):
        W[s0 + i] = W[s + i]
    W[T_LEFT] = np.inf


@njit(cache=True, error_model="numpy")
def begin_run(I, W):  # type: ignore[no-untyped-def]
    """Count the samples that lie before the start, or at it if the run continues one that has taken them."""
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED:
            I[row + COUNT] = max(0, int(np.ceil((W[T] - W[I[row + OFFSET]]) / W[I[row + PERIOD]] - 1e-9)))
            if due(I, W, row) <= W[SEEN] + clock(W):
                I[row + COUNT] += 1
    I[EVENTS_SEEN] = -2


@njit(cache=True, error_model="numpy")
def stop_at(I, W, at, level):  # type: ignore[no-untyped-def]
    """Do not step over ``at``; instants that differ by rounding only are one, at the last of them.

    While stops are collected, ``T_LEFT`` holds the first instant of the cluster and ``T_STOP`` the last.
    """
    near = resolution(at)
    if at < W[T_LEFT] - near:
        W[T_LEFT] = W[T_STOP] = at
        I[STOP_LEVEL] = level
    elif at <= W[T_LEFT] + near:
        W[T_LEFT] = min(W[T_LEFT], at)
        W[T_STOP] = max(W[T_STOP], at)
        I[STOP_LEVEL] = min(I[STOP_LEVEL], level)


@njit(cache=True, error_model="numpy")
def open_instant(ints, floats):  # type: ignore[no-untyped-def]
    """Begin an instant and publish, called from Python with the arrays themselves."""
    I, W = pointer_to(ints), pointer_to(floats)
    begin_instant(I, W)
    publish(I, W)


@njit(cache=True, error_model="numpy")
def take_sample(ints, floats, row):  # type: ignore[no-untyped-def]
    """Take the sample of one block if it is due, called from Python with the arrays themselves."""
    take(pointer_to(ints), pointer_to(floats), row)


@njit(cache=True, error_model="numpy")
def next_stop(I, W, t_end):  # type: ignore[no-untyped-def]
    """Find the next instant not to be stepped over and the largest step that the sources allow."""
    W[T_LEFT] = W[T_STOP] = t_end
    I[STOP_LEVEL] = 0
    largest = np.inf
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + KIND] == SAMPLED:
            stop_at(I, W, due(I, W, row), 0)
        elif I[row + KIND] == CONTINUOUS and I[row + A_NEXT] != 0:
            at = I[row + NEXT_TIME]
            call(I[row + A_NEXT], W[T], W, I[O_X] + I[row + X], I[row + D], I[row + U], I[row + P], at)
            if W[at] > W[T]:
                stop_at(I, W, W[at], 0)
            largest = min(largest, W[at + 1])
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
def top_of_parabola(start, middle, end):  # type: ignore[no-untyped-def]
    """Return where a function, known at the fractions 0, 1/2 and 1, may rise above zero in between, or 0."""
    bend = 2.0 * (start - 2.0 * middle + end)
    slope = 4.0 * middle - 3.0 * start - end
    if not (start <= 0.0 and bend < 0.0 and 0.0 < slope < -2.0 * bend):
        return 0.0
    rise = -0.25 * slope * slope / bend  # from the start to the top
    return -0.5 * slope / bend if start + rise > 0.1 * (min(start, end) - start - rise) else 0.0


@njit(cache=True, error_model="numpy")
def first_crossing(I, W, t, h):  # type: ignore[no-untyped-def]
    """Return the fraction of the step at which the first event fires, or 2 if none does.

    Looks at the end, at the middle and at the tops of the parabolas through start, middle and end, where an event
    may come and go; then closes in by the Illinois rule with bisection every third time.  Leaves the event functions
    of the end behind ``W[O_G]``.
    """
    ng = I[N_EVENTS]
    end = at_fraction(I, W, t, h, 1.0)
    for i in range(ng):
        W[I[O_G] + ng + i] = W[I[O_G] + i]
    left, right = 0.0, 0.5
    top = at_fraction(I, W, t, h, 0.5)
    low = -np.inf
    if top <= 0.0 and end <= 0.0:
        for i in range(ng):
            W[I[O_G] + 2 * ng + i] = W[I[O_G] + i]
        right = 0.0
        for i in range(ng):
            s = top_of_parabola(W[I[O_G0] + i], W[I[O_G] + 2 * ng + i], W[I[O_G] + ng + i])
            if s > 0.0:
                top = at_fraction(I, W, t, h, s)
                if top > 0.0:
                    right = s
                    break
        if right == 0.0:
            return 2.0
        low = at_fraction(I, W, t, h, 0.0)
        if low > 0.0:
            return 0.0
    elif top <= 0.0:
        left, right, low, top = 0.5, 1.0, top, end
    else:
        low = at_fraction(I, W, t, h, 0.0)
        if low > 0.0:
            return 0.0
    finest = clock(W) / h
    for turn in range(200):
        if right - left <= finest:
            break
        if turn % 3 == 2 or not np.isfinite(low):
            s = 0.5 * (left + right)
        else:
            s = left + (right - left) * low / (low - top)
            s = min(max(s, left + 0.5 * finest), right - 0.5 * finest)
        value = at_fraction(I, W, t, h, s)
        if value > 0.0:
            right, top = s, value
            low *= 0.5
        else:
            left, low = s, value
            top *= 0.5
    return right
