"""A component as an observer: from row to row by its own rates, set right at each row by what the row shows.

    z <- z + K (y_k - y(z, u_k))                                    at a row; y_k NaN sets nothing right
    a  = z + h phi_1(h J) f(z, u_k)                                 from row to row, J the slopes of f somewhere near
    z' = a + h phi_2(h J) (f(a, u_(k+1)) - f(z, u_k) - J (a - z))

Exact where f is linear and its inputs go along straight lines, of second order elsewhere, and stable however stiff, as
long as J is right within a factor of two (exponential Rosenbrock method: Hochbruck and Ostermann 2010, sec. 2.4).
z are the component's states and, behind them, loads that decay, l' = -l / time.
"""

import numpy as np
from stickslip.engine.call import pointer_to
from stickslip.engine.events import fire_positive, watch_rates
from stickslip.engine.layout import CHAIN, EV_ROOM, MAX_CHAIN, N_EVENTS, N_STATES, O_F, O_X
from stickslip.engine.sweep import events_of_signals, rates, signals
from stickslip.logs.compiled import njit

SHARE = 1e-6  # of a state's size: step that shows a slope


@njit(cache=True, error_model="numpy")
def observed(ints, floats, into, loaded, shown, u, begins, ends, y, K, which, decay, J, P_1, P_2, z):  # type: ignore[no-untyped-def]
    """Return y - y(z) before each row sets z right, (rows, outputs); ``z`` is left as it is predicted behind them.

    ``into``, ``loaded``, ``shown``: places in the floats of inputs, loads and outputs; ``u`` (rows, inputs) at each
    row, ``begins``, ``ends`` the line that they go along behind it; ``K`` (kinds, states, outputs), of which
    ``which`` (rows,) holds; ``decay`` (loads,) [1/s]; ``P_1``, ``P_2`` h phi_1, h phi_2.
    """
    I, W = pointer_to(ints), pointer_to(floats)
    rows, m = y.shape
    n = len(z)
    e = np.empty((rows, m))
    f, g, a = np.empty(n), np.empty(n), np.empty(n)
    for k in range(rows):
        put(W, into, u[k])
        state(I, W, z, loaded)
        settled(I, W)
        for j in range(m):
            e[k, j] = y[k, j] - W[shown[j]]
        for i in range(n):
            for j in range(m):
                if e[k, j] == e[k, j]:
                    z[i] += K[which[k], i, j] * e[k, j]
        put(W, into, begins[k])
        fall(I, W, z, loaded, decay, f)
        for i in range(n):
            s = z[i]
            for j in range(n):
                s += P_1[i, j] * f[j]
            a[i] = s
        put(W, into, ends[k])
        fall(I, W, a, loaded, decay, g)
        for i in range(n):
            s = g[i] - f[i]
            for j in range(n):
                s -= J[i, j] * (a[j] - z[j])
            f[i] = s
        for i in range(n):
            s = a[i]
            for j in range(n):
                s += P_2[i, j] * f[j]
            g[i] = s
        for i in range(n):
            z[i] = g[i]
    return e


@njit(cache=True, error_model="numpy")
def slopes_at(ints, floats, into, loaded, u, decay, z, size):  # type: ignore[no-untyped-def]
    """Return the slopes of the rates of ``z`` over ``z``, (n, n), at inputs ``u``, by differences across ``z``."""
    I, W = pointer_to(ints), pointer_to(floats)
    n = len(z)
    J, up, down, moved = np.empty((n, n)), np.empty(n), np.empty(n), z.copy()
    put(W, into, u)
    state(I, W, z, loaded)
    watch_rates(I, W)
    settled(I, W)
    for j in range(n):
        h = SHARE * size[j]
        moved[j] = z[j] + h
        fall(I, W, moved, loaded, decay, up)
        moved[j] = z[j] - h
        fall(I, W, moved, loaded, decay, down)
        moved[j] = z[j]
        for i in range(n):
            J[i, j] = (up[i] - down[i]) / (2.0 * h)
    return J


@njit(cache=True, error_model="numpy")
def put(W, places, values):  # type: ignore[no-untyped-def]
    """Write values to places."""
    for j in range(len(places)):
        W[places[j]] = values[j]


@njit(cache=True, error_model="numpy")
def state(I, W, z, loaded):  # type: ignore[no-untyped-def]
    """Let the component be where ``z`` says, its states first, then its loads."""
    n = I[N_STATES]
    for i in range(n):
        W[I[O_X] + i] = z[i]
    for j in range(len(loaded)):
        W[loaded[j]] = z[n + j]


@njit(cache=True, error_model="numpy")
def settled(I, W):  # type: ignore[no-untyped-def]
    """Compute every signal, blocks with modes in the mode that is right here: the stretch of a table, a limit."""
    signals(I, W, 0.0)
    I[CHAIN] = I[EV_ROOM] = 0
    while I[N_EVENTS] > 0 and I[CHAIN] <= I[MAX_CHAIN]:
        events_of_signals(I, W, 0.0)
        if not fire_positive(I, W, W):  # nothing is noted: there is no room
            break
        signals(I, W, 0.0)


@njit(cache=True, error_model="numpy")
def fall(I, W, z, loaded, decay, f):  # type: ignore[no-untyped-def]
    """Write to ``f`` the rates of ``z``."""
    n = I[N_STATES]
    state(I, W, z, loaded)
    rates(I, W, 0.0)
    for i in range(n):
        f[i] = W[I[O_F] + i]
    for j in range(len(loaded)):
        f[n + j] = -decay[j] * z[n + j]
