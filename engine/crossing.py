"""Where in a step the first event fires, found on its dense output."""

import numpy as np
from stickslip.engine.dense import interpolate
from stickslip.engine.floats import copy
from stickslip.engine.layout import (
    CLOSER,
    METHOD,
    N_EVENTS,
    N_SIGNALS,
    N_STATES,
    O_F,
    O_G,
    O_G0,
    O_RATE,
    O_S,
    O_X,
    O_Y1,
    P_EVENT_SIGNALS,
    P_EVENTS,
    RATES_NOW,
    REJECTED,
    STEP,
)
from stickslip.engine.sweep import clock, evaluate_events, play, signal_rates
from stickslip.logs.compiled import njit

GLANCE = 1.0 / 64.0  # share of a step over which a glance takes rates
MOST_CLOSER = 3  # a stiff step is shortened so many times to end just behind an event, where its states are best:
COARSE = 1e-3  # an event is first located to this share of the step,
BEHIND = 1.003  # the next try ends a little behind it,
END = 0.99  # and is taken if the event lies behind this share of it


@njit(cache=True, error_model="numpy")
def highest(I, W):  # type: ignore[no-untyped-def]
    """Return the largest event function among those that were not positive at the left of the interval."""
    top = -np.inf
    for i in range(I[N_EVENTS]):
        if W[I[O_G0] + i] <= 0.0:
            top = max(top, W[I[O_G] + i])
    return top


@njit(cache=True, error_model="numpy", inner=True)
def at_fraction(I, W, t, h, s):  # type: ignore[no-untyped-def]
    """Evaluate the event functions at the fraction ``s`` of the step; return the largest."""
    interpolate(I, W, s)
    evaluate_events(I, W, t + s * h)
    return highest(I, W)


@njit(cache=True, error_model="numpy")
def at_end(I, W, t, h, there):  # type: ignore[no-untyped-def]
    """Evaluate the event functions at the end of the step, where states and rates are known; return the largest.

    ``there``: states, rates and signals still stand where the step has left them.
    """
    if not there:
        n = I[N_STATES]
        copy(W, I[O_Y1], I[O_X], n)
        copy(W, I[O_Y1] + n, I[O_F], n)
        play(I, W, t + h, P_EVENT_SIGNALS)
    if I[RATES_NOW]:
        signal_rates(I, W, t + h)
    play(I, W, t + h, P_EVENTS)
    return highest(I, W)


@njit(cache=True, error_model="numpy", inner=True)
def glance(I, W, t, h, s):  # type: ignore[no-untyped-def]
    """Evaluate the event functions inside the step as ``at_fraction`` does, but take rates from the dense output."""
    if I[RATES_NOW]:
        later, kept = s + GLANCE, I[O_RATE]
        interpolate(I, W, later)
        play(I, W, t + later * h, P_EVENT_SIGNALS)
        for i in range(I[N_SIGNALS]):
            W[kept + i] = W[I[O_S] + i]
        interpolate(I, W, s)
        play(I, W, t + s * h, P_EVENT_SIGNALS)
        for i in range(I[N_SIGNALS]):
            W[kept + i] = (W[kept + i] - W[I[O_S] + i]) / (GLANCE * h)
    else:
        interpolate(I, W, s)
        play(I, W, t + s * h, P_EVENT_SIGNALS)
    play(I, W, t + s * h, P_EVENTS)
    return highest(I, W)


@njit(cache=True, error_model="numpy", inner=True)
def top_of_parabola(start, middle, end):  # type: ignore[no-untyped-def]
    """Return where a function, known at the fractions 0, 1/2 and 1, may rise above zero in between, or 0."""
    bend = 2.0 * (start - 2.0 * middle + end)
    slope = 4.0 * middle - 3.0 * start - end
    if not (start <= 0.0 and bend < 0.0 and 0.0 < slope < -2.0 * bend):
        return 0.0
    rise = -0.25 * slope * slope / bend  # from the start to the top
    return -0.5 * slope / bend if start + rise > 0.1 * (min(start, end) - start - rise) else 0.0


@njit(cache=True, error_model="numpy", inner=True)
def first_crossing(I, W, t, h, finest, there):  # type: ignore[no-untyped-def]
    """Return the fraction of the step at which the first event fires, to within ``finest``, or 2 if none does.

    Looks at the end, at the middle and at the tops of the parabolas through start, middle and end, where an event
    may come and go, be it before another one at the end; then closes in by the Illinois rule with bisection every third
    time.  Leaves the event functions
    of the end behind ``W[O_G]``.  ``there``: see ``at_end``.
    """
    ng = I[N_EVENTS]
    end = at_end(I, W, t, h, there)
    for i in range(ng):
        W[I[O_G] + ng + i] = W[I[O_G] + i]
    left, right = 0.0, 0.5
    top = glance(I, W, t, h, 0.5)
    if top > 0.0:
        top = at_fraction(I, W, t, h, 0.5)
    low, middle = -np.inf, top
    if middle <= 0.0:
        for i in range(ng):
            W[I[O_G] + 2 * ng + i] = W[I[O_G] + i]
        right = 0.0
        for i in range(ng):
            s = top_of_parabola(W[I[O_G0] + i], W[I[O_G] + 2 * ng + i], W[I[O_G] + ng + i])
            if 0.0 < s < (0.5 if end > 0.0 else 1.0):
                top = at_fraction(I, W, t, h, s)
                if top > 0.0:
                    right = s
                    break
        if right == 0.0 and end <= 0.0:
            return 2.0
    if right == 0.0:
        left, right, low, top = 0.5, 1.0, middle, end
    else:
        low = at_fraction(I, W, t, h, 0.0)
        if low > 0.0:
            return 0.0
    finest = max(finest, clock(W) / h)
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


@njit(cache=True, error_model="numpy", inner=True)
def crossing_ahead(I, W, t, h):  # type: ignore[no-untyped-def]
    """Return the fraction at which the first event fires, 2 if none does, -1 if a stiff step is to be tried shorter."""
    coarse = I[METHOD] == 1 and I[CLOSER] < MOST_CLOSER
    crossing = first_crossing(I, W, t, h, COARSE if coarse else 0.0, I[METHOD] != 2)
    if coarse and crossing < END and crossing * h > 1e-6:
        W[STEP] = BEHIND * crossing * h
        I[CLOSER] += 1
        I[REJECTED] += 1
        return -1.0
    if coarse and crossing <= 1.0:
        crossing = first_crossing(I, W, t, h, 0.0, False)
    I[CLOSER] = 0
    return crossing
