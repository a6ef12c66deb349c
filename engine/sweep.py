"""One pass over the blocks of a component in signal-flow order: signals, rates, event functions.

All functions work on the two arrays of ``engine.layout``; the states they see are those at ``W[O_X]``.
"""

import numpy as np
from numba import njit

from engine.call import call, pointer_to
from engine.delay import delayed
from engine.layout import (
    A_DER,
    A_OUT,
    A_ZC,
    CONTINUOUS,
    DEAD_TIME,
    FEEDS,
    GATHER,
    HAS_RATES,
    KIND,
    N_BLOCKS,
    N_SIGNALS,
    N_STATES,
    NG,
    NU,
    NX,
    O_F,
    O_G,
    O_RATE,
    O_S,
    O_TMP,
    O_X,
    RATES,
    RHS,
    T_LEFT,
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


@njit(cache=True, error_model="numpy")
def gather(I, W, row):  # type: ignore[no-untyped-def]
    """Copy the signals wired to a block into its input buffer."""
    s = I[O_S]
    u = I[row + U]
    wires = I[row + WIRES]
    for i in range(I[row + GATHER]):
        W[u + i] = W[s + I[wires + i]]


@njit(cache=True, error_model="numpy")
def signals(I, W, t):  # type: ignore[no-untyped-def]
    """Compute every signal at time ``t`` from the states at ``W[O_X]``."""
    if t > W[T_LEFT]:
        t = W[T_LEFT]
    x, s = I[O_X], I[O_S]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        kind = I[row + KIND]
        if kind == CONTINUOUS:
            if I[row + FEEDS]:
                u = I[row + U]
                wires = I[row + WIRES]
                for i in range(I[row + GATHER]):
                    W[u + i] = W[s + I[wires + i]]
            call(I[row + A_OUT], t, W, x + I[row + X], I[row + D], I[row + U], I[row + P], s + I[row + Y])
        elif kind == DEAD_TIME:
            W[s + I[row + Y]] = delayed(I, W, row, t)


@njit(cache=True, error_model="numpy")
def rates(I, W, t):  # type: ignore[no-untyped-def]
    """Compute every signal and every state rate at time ``t`` from the states at ``W[O_X]``."""
    signals(I, W, t)
    if t > W[T_LEFT]:
        t = W[T_LEFT]
    I[RHS] += 1
    x, f, s = I[O_X], I[O_F], I[O_S]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + NX] > 0:
            u = I[row + U]
            wires = I[row + WIRES]
            for i in range(I[row + GATHER]):
                W[u + i] = W[s + I[wires + i]]
            call(I[row + A_DER], t, W, x + I[row + X], I[row + D], u, I[row + P], f + I[row + X])


@njit(cache=True, error_model="numpy")
def signal_rates(I, W, t, scale):  # type: ignore[no-untyped-def]
    """Estimate d(signal)/dt along the flow by one shifted sweep; needs ``W[O_F]`` and the signals at ``t``."""
    n, ns = I[N_STATES], I[N_SIGNALS]
    x, f, s, r, tmp = I[O_X], I[O_F], I[O_S], I[O_RATE], I[O_TMP]
    shift = 1e-6 * max(scale, 1e-3 * (1.0 + 1e-6 * abs(t)))
    if t + shift > W[T_LEFT]:
        shift = -shift
    shift = (t + shift) - t
    for i in range(n):
        W[tmp + i] = W[x + i]
        W[x + i] += shift * W[f + i]
    for i in range(ns):
        W[r + i] = W[s + i]
    signals(I, W, t + shift)
    for i in range(ns):
        now = W[s + i]
        W[s + i] = W[r + i]
        W[r + i] = (now - W[r + i]) / shift
    for i in range(n):
        W[x + i] = W[tmp + i]


@njit(cache=True, error_model="numpy")
def gather_with_rates(I, W, row):  # type: ignore[no-untyped-def]
    """Fill a block's input buffer with its inputs and, behind them, their rates if it asks for them."""
    gather(I, W, row)
    if I[row + RATES]:
        nu = I[row + NU]
        wires = I[row + WIRES]
        for i in range(nu):
            W[I[row + U] + nu + i] = W[I[O_RATE] + I[wires + i]]


@njit(cache=True, error_model="numpy")
def event_functions(I, W, t):  # type: ignore[no-untyped-def]
    """Evaluate all event functions at ``t``; signals (and rates, where asked for) must be current."""
    if t > W[T_LEFT]:
        t = W[T_LEFT]
    for b in range(I[N_BLOCKS]):
        row = H + b * R
        if I[row + NG] > 0:
            gather_with_rates(I, W, row)
            call(
                I[row + A_ZC],
                t,
                W,
                I[O_X] + I[row + X],
                I[row + D],
                I[row + U],
                I[row + P],
                I[O_G] + I[row + G],
            )


@njit(cache=True, error_model="numpy")
def evaluate_events(I, W, t, scale):  # type: ignore[no-untyped-def]
    """Bring signals, rates (where asked for) and event functions up to date at ``t``."""
    if I[HAS_RATES]:
        rates(I, W, t)
        signal_rates(I, W, t, scale)
    else:
        signals(I, W, t)
    event_functions(I, W, t)


@njit(cache=True, error_model="numpy")
def finite(W, start, n):  # type: ignore[no-untyped-def]
    """Return whether ``n`` floats from ``start`` are all finite."""
    total = 0.0
    for i in range(n):
        total += W[start + i] * 0.0
    return total == 0.0 and not np.isnan(total)


@njit(cache=True, error_model="numpy")
def resolution(t):  # type: ignore[no-untyped-def]
    """Return the smallest time difference that counts at ``t`` [s]."""
    return 4.0 * np.spacing(max(1.0, abs(t)))


@njit(cache=True, error_model="numpy")
def clock(W):  # type: ignore[no-untyped-def]
    """Return the smallest time difference that the present time can resolve [s]."""
    return resolution(W[T])


@njit(cache=True, error_model="numpy")
def refresh(ints, floats, t):  # type: ignore[no-untyped-def]
    """Compute every signal at ``t``, called from Python with the arrays themselves."""
    signals(pointer_to(ints), pointer_to(floats), t)
