"""One pass over the blocks of a component in signal-flow order: signals, rates, event functions.

All functions work on the two arrays of ``stickslip.engine.layout``; the states they see are those at ``W[O_X]``.
"""

from stickslip.engine.call import call
from stickslip.engine.delay import delayed
from stickslip.engine.layout import (
    GATHER,
    N_SIGNALS,
    N_STATES,
    NU,
    O_F,
    O_RATE,
    O_S,
    O_TMP,
    O_X,
    P_EVENT_SIGNALS,
    P_EVENTS,
    P_MOVING,
    P_RATES,
    P_SIGNALS,
    RATES,
    RATES_NOW,
    RHS,
    SKIPPED,
    T_LEFT,
    WIRES,
    T,
    U,
)
from stickslip.logs.compiled import njit

ROUNDING = 2.0**-50
AHEAD = 1e-7  # [s]: over which rates of signals are taken.  Shorter, rounding would decide the sign of small ones;
#               always the same, or a block that looks at one before a kink would see it come and go


@njit(cache=True, error_model="numpy")
def gather(I, W, row):  # type: ignore[no-untyped-def]
    """Copy the signals wired to a block into its input buffer."""
    s = I[O_S]
    u = I[row + U]
    wires = I[row + WIRES]
    for i in range(I[row + GATHER]):
        W[u + i] = W[s + I[wires + i]]


@njit(cache=True, error_model="numpy")
def play(I, W, t, program):  # type: ignore[no-untyped-def]
    """Carry out the calls of a program (``stickslip.engine.layout``) at time ``t``; ``program`` is its place in the
    header.
    """
    play_calls(I, W, t, I[program], I[program + 1])


@njit(cache=True, error_model="numpy", inner=True)
def play_calls(I, W, t, at, calls):  # type: ignore[no-untyped-def]
    """Carry out so many calls of a program, the first of which stands at ``at``."""
    if t > W[T_LEFT]:
        t = W[T_LEFT]
    for _ in range(calls):
        where, x, d, u, p, out, count = I[at], I[at + 1], I[at + 2], I[at + 3], I[at + 4], I[at + 5], I[at + 6]
        at += 7
        for i in range(count):
            W[u + i] = W[I[at + i]]
        at += count
        if where > SKIPPED:
            call(where, t, W, x, d, u, p, out)
        elif where == 0:
            W[out] = delayed(I, W, x, t)


@njit(cache=True, error_model="numpy")
def signals(I, W, t):  # type: ignore[no-untyped-def]
    """Compute every signal at time ``t`` from the states at ``W[O_X]``."""
    play(I, W, t, P_SIGNALS)


@njit(cache=True, error_model="numpy")
def rates(I, W, t):  # type: ignore[no-untyped-def]
    """Compute every state rate at time ``t`` from the states at ``W[O_X]``, and the signals needed for them."""
    I[RHS] += 1
    play(I, W, t, P_MOVING)
    play(I, W, t, P_RATES)


@njit(cache=True, error_model="numpy", inner=True)
def signal_rates(I, W, t):  # type: ignore[no-untyped-def]
    """Estimate d(signal)/dt along the flow by one shifted sweep; needs ``W[O_F]`` and the signals at ``t``.

    Only signals that event functions need are looked at.
    """
    n, ns = I[N_STATES], I[N_SIGNALS]
    x, f, s, r, tmp = I[O_X], I[O_F], I[O_S], I[O_RATE], I[O_TMP]
    shift = AHEAD * (1.0 + 1e-8 * abs(t))
    if t + shift > W[T_LEFT]:
        shift = -shift
    shift = (t + shift) - t
    for i in range(n):
        W[tmp + i] = W[x + i]
        W[x + i] += shift * W[f + i]
    for i in range(ns):
        W[r + i] = W[s + i]
    play(I, W, t + shift, P_EVENT_SIGNALS)
    for i in range(ns):
        now = W[s + i]
        W[s + i] = W[r + i]
        W[r + i] = (now - W[r + i]) / shift
    for i in range(n):
        W[x + i] = W[tmp + i]


@njit(cache=True, error_model="numpy", inner=True)
def gather_with_rates(I, W, row):  # type: ignore[no-untyped-def]
    """Fill a block's input buffer with its inputs and, behind them, their rates if it asks for them."""
    gather(I, W, row)
    if I[row + RATES]:
        nu = I[row + NU]
        wires = I[row + WIRES]
        for i in range(nu):
            W[I[row + U] + nu + i] = W[I[O_RATE] + I[wires + i]]


@njit(cache=True, error_model="numpy", inner=True)
def evaluate_events(I, W, t):  # type: ignore[no-untyped-def]
    """Bring signals, rates (where asked for) and event functions up to date at ``t``."""
    play(I, W, t, P_MOVING if I[RATES_NOW] else P_EVENT_SIGNALS)
    events_of_signals(I, W, t)


@njit(cache=True, error_model="numpy", inner=True)
def events_of_signals(I, W, t):  # type: ignore[no-untyped-def]
    """Bring rates (where asked for) and event functions up to date; the signals must be those at ``t``."""
    if I[RATES_NOW]:
        I[RHS] += 1
        play(I, W, t, P_RATES)
        signal_rates(I, W, t)
    play(I, W, t, P_EVENTS)


@njit(cache=True, error_model="numpy")
def resolution(t):  # type: ignore[no-untyped-def]
    """Return the smallest time difference that counts at ``t`` [s]: four to eight times what its floats differ by."""
    return ROUNDING * max(1.0, abs(t))


@njit(cache=True, error_model="numpy")
def clock(W):  # type: ignore[no-untyped-def]
    """Return the smallest time difference that the present time can resolve [s]."""
    return resolution(W[T])
