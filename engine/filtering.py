"""The filter: how a state and its spread go from stop to stop, and what each row of a log says of them.

    between stops     z' = f(z),   A = df/dz,   H = dy/dz           differences across the run of the diagram itself
    noise             z' += B w,   y += G w,    w ~ N(0, sd^2 (1 - phi^2)) for each source, drawn at the stop
    spread            D = [A L, B sd sqrt(1 - phi^2)],  Y = [H L, G sd sqrt(1 - phi^2)],     P = L L', P' = D D'
    at a row          e = (y - y(z)) / sqrt(s),  s = Y Y' + r,  K = D Y' / s,  z' += K sqrt(s) e,
                      D -= K Y s / (s + sqrt(s r))                     one signal after the other

The mean follows every nonlinearity, since f is the run of the diagram; differences go over sqrt 3 standard deviations
of each state, which keeps the third moment; what bends there (a limit, a kink) adds to the spread.  Slopes serve other
stops that they foretell, and other sizes of noise, which need no run.  Near a limit a row is run again from the stop
before it, with what each of its signals says.
Source: the extended filter of Anderson and Moore, Optimal Filtering (1979), section 8.2, in the square root form of
Potter (Maybeck, Stochastic Models, Estimation and Control 1 (1979), section 7.3); second differences in the spread as
in Norgaard, Poulsen and Ravn, Automatica 36 (2000), section 4.
"""

import math

import numpy as np
from numba import njit

from engine.layout import COUNT, EVENTS, N_BLOCKS, R
from engine.layout import H as H0
from engine.restarts import arrive, pass_instant, put, read, restore

WIDE = math.sqrt(3.0)
SHARP = 12.0  # mean square of b x^2 is c^2 / 12, where c = f(+) + f(-) - 2 f(0) sqrt 3 standard deviations away
DROPPED = 1e-13  # share of its size below which what is left of a state's variance is rounding
NARROWEST = 1e-7  # of a state's size: the least difference that shows a slope
FACTOR = 2  # columns of the spread's factor, over what is needed at least: more of them, and it is narrowed less often
KINKED = 0.5  # standard deviations by which signals may miss their slopes over all that is likely
FAR = 4.0  # standard deviations within which a row may find the state
BENT = 0.05  # share of its spread by which a stop may lie off the slopes of another that stand for its own
KINDS = 8  # of stops whose slopes are kept
STALE = 0.1  # of the rounding's variance: a value that is surer, and is as foretold, says nothing


@njit(cache=True, error_model="numpy")
def compressed(D, columns, size, L):  # type: ignore[no-untyped-def]
    """Write a factor of D D' with as few columns as it takes to ``L``; return how many (Cholesky with pivots)."""
    n = len(size)
    P = np.empty((n, n))
    for i in range(n):
        for k in range(i + 1):
            s = 0.0
            for j in range(columns):
                s += D[i, j] * D[k, j]
            P[i, k] = P[k, i] = s / (size[i] * size[k])
    rest = np.empty(n)
    for i in range(n):
        rest[i] = P[i, i]
    found = 0
    while found < n:
        p, top = 0, -1.0
        for i in range(n):
            if rest[i] > top and rest[i] > DROPPED * P[i, i]:
                p, top = i, rest[i]
        if top <= 0.0:
            break
        root = math.sqrt(top)
        for i in range(n):
            s = P[i, p]
            for j in range(found):
                s -= L[i, j] * L[p, j] / (size[i] * size[p])
            L[i, found] = s / root * size[i]
        for i in range(n):
            rest[i] -= (L[i, found] / size[i]) ** 2
        rest[p] = -1.0
        found += 1
    return found


@njit(cache=True, error_model="numpy")
def spread_to(A, B, H, G, sd, D, columns, E, Y):  # type: ignore[no-untyped-def]
    """Write the spread behind a stop, of the state to ``E`` and of signals to ``Y``; return how many columns it has."""
    n, m, q = len(A), len(H), len(sd)
    for i in range(n):
        E[i, :columns] = 0.0
        for k in range(n):
            if A[i, k] != 0.0:  # a dead time is a chain of states, each of which has one slope
                for j in range(columns):
                    E[i, j] += A[i, k] * D[k, j]
    for i in range(m):
        Y[i, :columns] = 0.0
        for k in range(n):
            if H[i, k] != 0.0:
                for j in range(columns):
                    Y[i, j] += H[i, k] * D[k, j]
    width = columns
    for j in range(q + 1):  # the last is what bends
        by = sd[j] if j < q else 1.0
        if by > 0.0 and (j < q or bent(B, G)):
            for i in range(n):
                E[i, width] = B[i, j] * by
            for i in range(m):
                Y[i, width] = G[i, j] * by
            width += 1
    return width


@njit(cache=True, error_model="numpy")
def bent(B, G):  # type: ignore[no-untyped-def]
    """Return whether slopes have a bend, which stands in the last column."""
    q = B.shape[1] - 1
    return np.any(B[:, q] != 0.0) or np.any(G[:, q] != 0.0)


@njit(cache=True, error_model="numpy")
def narrowed(D, columns, size, q):  # type: ignore[no-untyped-def]
    """Write a factor ``D`` with fewer columns where it has no room for those of ``q`` noises; return how many."""
    if columns + q + 1 <= D.shape[1]:
        return columns
    L = np.empty((len(D), len(D)))
    columns = compressed(D, columns, size, L)
    D[:, :columns] = L[:, :columns]
    return columns


@njit(cache=True, error_model="numpy")
def with_room(pool, count):  # type: ignore[no-untyped-def]
    """Return a pool of slopes that has room for one more."""
    if count < len(pool):
        return pool
    larger = np.empty((2 * count, pool.shape[1], pool.shape[2]))
    larger[:count] = pool
    return larger


@njit(cache=True, error_model="numpy")
def taken_in(i, value, before, r, width, E, F, Y, z, back, y, gains, e, S):  # type: ignore[no-untyped-def]
    """Let signal ``i`` of a row set the state right, and the signals behind it; return whether it says anything.

    ``before``: its value in the row before.  ``back``, of the factor ``F``: where the run left from, and what is drawn.
    """
    n, m = len(z), len(y)
    if value != value:
        return False
    s = 0.0
    for j in range(width):
        s += Y[i, j] * Y[i, j]
    off = value - y[i]
    if s < STALE * r and (value == before or off * off < 3.1 * r):
        return False  # held, or at a limit: nothing random is in it
    s += r
    e[i], S[i] = off / math.sqrt(s), s
    less = 1.0 / (1.0 + math.sqrt(r / s))
    own = Y[i, :width].copy()
    set_right(E, own, width, s, off, less, z, gains[:n, i])
    set_right(Y, own, width, s, off, less, y, gains[n : n + m, i])
    set_right(F, own, width, s, off, less, back, gains[n + m :, i])
    return True


@njit(cache=True, error_model="numpy")
def set_right(E, own, width, s, off, less, z, gains):  # type: ignore[no-untyped-def]
    """Move ``z`` of the factor ``E`` by what an innovation ``off`` of variance ``s`` says, and narrow its spread."""
    for p in range(len(E)):
        g = 0.0
        for j in range(width):
            g += E[p, j] * own[j]
        g /= s
        z[p] += g * off
        gains[p] = g
        for j in range(width):
            E[p, j] -= less * g * own[j]


@njit(cache=True, error_model="numpy")
def arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, z, drawn):  # type: ignore[no-untyped-def]
    """Run from a state ``z`` past an instant, where noise goes on and is ``drawn``; return a status."""
    no_rows = np.empty((1, 0))
    restore(I, W, base_I, base_W)
    put(I, W, places, z)
    status = arrive(I, W, buffer, no_rows, t)
    if status != 0:
        return status
    for j in range(len(noisy)):
        W[noisy[j]] = W[noisy[j]] * phi[j] + drawn[j]
    return pass_instant(I, W, buffer, no_rows)


@njit(cache=True, nogil=True, error_model="numpy")
def followed(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, shown, noisy, times, row_of, phi, values, gains, kinks, z, at_rows, missed,
):  # fmt: skip
    """Follow the mean alone, set right by known ``gains`` (see ``extended``); ``kinks``: rows that are run again.

    Written are what the mean shows ``at_rows``, and what each signal ``missed`` once those before it are known.
    """
    n, m, q = len(places), len(shown), len(noisy)
    no_rows, y, back = np.empty((1, 0)), np.empty(m), np.zeros(n + q)
    base_I, base_W = I[:kept].copy(), W[:saved].copy()
    for k in range(len(times)):
        row = row_of[k]
        again = row >= 0 and kinks[row]
        if again:
            base_I[:], base_W[:] = I[:kept], W[:saved]
            back[:n], back[n:] = z, 0.0
        put(I, W, places, z)
        status = arrive(I, W, buffer, no_rows, times[k])
        if status != 0:
            return status
        for j in range(q):
            W[noisy[j]] *= phi[k, j]
        status = pass_instant(I, W, buffer, no_rows)
        if status != 0:
            return status
        read(W, places, z)
        if row < 0:
            continue
        read(W, shown, y)
        at_rows[row] = y
        for i in range(m):
            if values[row, i] != values[row, i]:
                continue
            off = values[row, i] - y[i]
            missed[row, i] = off
            for p in range(n):
                z[p] += gains[row, p, i] * off
            for p in range(m):
                y[p] += gains[row, n + p, i] * off
            if again:
                for p in range(n + q):
                    back[p] += gains[row, n + m + p, i] * off
                status = arrived(I, W, buffer, base_I, base_W, places, noisy, times[k], phi[k], back[:n], back[n:])
                if status != 0:
                    return status
                read(W, places, z)
                read(W, shown, y)
    return 0


@njit(cache=True, error_model="numpy")
def slopes_at(  # type: ignore[no-untyped-def]
    I, W, buffer, base_I, base_W, stop_I, stop_W, places, shown, noisy, at, size, t, phi, sd, z, at_stop, D, columns,
    behind, y, A, B, H, G,
):  # fmt: skip
    """Write the slopes of what a stretch and the stop behind it make of the state, and of a noise drawn there.

    The last columns of ``B`` and ``G`` are what bends: the root of the mean square of what slopes leave.
    """
    n, m, q = len(places), len(shown), len(noisy)
    bend, y_bend, most = np.zeros(n), np.zeros(m), 0.0
    B[:, q] = 0.0
    G[:, q] = 0.0
    no_rows = np.empty((1, 0))
    up, down, y_up, y_down, moved_z = np.empty(n), np.empty(n), np.empty(m), np.empty(m), np.empty(n)
    for i in range(n):
        variance = 0.0
        for j in range(columns):
            variance += D[i, j] ** 2
        far = WIDE * max(math.sqrt(variance), NARROWEST * size[i])
        for way in range(2):
            moved_z[:] = z
            moved_z[i] += far if way == 0 else -far
            restore(I, W, base_I, base_W)
            put(I, W, places, moved_z)
            status = arrive(I, W, buffer, no_rows, t)
            if status == 0:
                for j in range(len(noisy)):
                    W[noisy[j]] *= phi[j]
                status = pass_instant(I, W, buffer, no_rows)
            if status != 0:
                return status
            read(W, places, up if way == 0 else down)
            read(W, shown, y_up if way == 0 else y_down)
        A[:, i] = (up - down) / (2.0 * far)
        H[:, i] = (y_up - y_down) / (2.0 * far)
        most = add_bend(up, down, behind, y_up, y_down, y, bend, y_bend, most, B[:, q], G[:, q])
    for j in range(len(noisy)):
        B[:, j] = 0.0
        G[:, j] = 0.0
        if sd[j] > 0.0:
            far = WIDE * sd[j]
            for way in range(2):
                restore(I, W, stop_I, stop_W)
                W[noisy[j]] = at_stop[at[j]] + (far if way == 0 else -far)
                status = pass_instant(I, W, buffer, no_rows)
                if status != 0:
                    return status
                read(W, places, up if way == 0 else down)
                read(W, shown, y_up if way == 0 else y_down)
            B[:, j] = (up - down) / (2.0 * far)
            G[:, j] = (y_up - y_down) / (2.0 * far)
            most = add_bend(up, down, behind, y_up, y_down, y, bend, y_bend, most, B[:, q], G[:, q])
    one_bend(A, H, B, G, sd, D, columns, bend, y_bend)
    return 0


@njit(cache=True, error_model="numpy")
def add_bend(up, down, middle, y_up, y_down, y_middle, bend, y_bend, most, way, y_way):  # type: ignore[no-untyped-def]
    """Add the squares of what slopes leave to both sides; keep the ``way`` of the largest; return its size."""
    total = 0.0
    for i in range(len(bend)):
        bend[i] += (up[i] + down[i] - 2.0 * middle[i]) ** 2
    for i in range(len(y_bend)):
        c = y_up[i] + y_down[i] - 2.0 * y_middle[i]
        y_bend[i] += c**2
        total += c**2
    if total > most:
        for i in range(len(bend)):
            way[i] = up[i] + down[i] - 2.0 * middle[i]
        for i in range(len(y_bend)):
            y_way[i] = y_up[i] + y_down[i] - 2.0 * y_middle[i]
        return total
    return most


@njit(cache=True, error_model="numpy")
def one_bend(A, H, B, G, sd, D, columns, bend, y_bend):  # type: ignore[no-untyped-def]
    """Make one column of what bends, with the signs of the largest; none where it is a small part of the spread."""
    n, m, q = len(A), len(H), len(sd)
    shows = False
    for i in range(m):
        variance = 0.0
        for j in range(columns):
            s = 0.0
            for k in range(n):
                s += H[i, k] * D[k, j]
            variance += s * s
        for j in range(q):
            variance += (G[i, j] * sd[j]) ** 2
        shows = shows or y_bend[i] / SHARP > BENT**2 * variance
    for i in range(n):
        B[i, q] = math.copysign(math.sqrt(bend[i] / SHARP), B[i, q]) if shows else 0.0
    for i in range(m):
        G[i, q] = math.copysign(math.sqrt(y_bend[i] / SHARP), G[i, q]) if shows else 0.0


@njit(cache=True, error_model="numpy")
def same_kind(base, behind, kinds, known, times, phi, sd, k):  # type: ignore[no-untyped-def]
    """Return the slot of stops like this one, by what sampled on the way; -1 for one with events, or for none left."""
    if k == 0 or behind[EVENTS] != base[EVENTS]:
        return -1
    for slot in range(len(known)):
        if known[slot] < 0:
            for b in range(kinds.shape[1]):
                kinds[slot, b] = behind[H0 + b * R + COUNT] - base[H0 + b * R + COUNT]
            return slot
        other = known[slot]
        alike = abs((times[k] - times[k - 1]) - (times[other] - times[other - 1])) < 1e-9 * times[k]
        for j in range(phi.shape[1]):
            alike = alike and abs(phi[k, j] - phi[other, j]) < 1e-9 and sd[k, j] == sd[other, j]
        for b in range(kinds.shape[1]):
            alike = alike and kinds[slot, b] == behind[H0 + b * R + COUNT] - base[H0 + b * R + COUNT]
        if alike:
            return slot
    return -1


@njit(cache=True, error_model="numpy")
def foretold(A, B, H, G, sd, D, columns, E, Y, z, behind, y, from_z, to_z, to_y, size):  # type: ignore[no-untyped-def]
    """Return how many columns the spread has by slopes of another stop; -1 if they do not foretell this one.

    They do if they miss it by a small part of its spread at most.
    """
    n, m = len(z), len(y)
    width = spread_to(A, B, H, G, sd, D, columns, E, Y)
    for i in range(n):
        off = behind[i] - to_z[i]
        for j in range(n):
            off -= A[i, j] * (z[j] - from_z[j])
        variance = 0.0
        for j in range(width):
            variance += E[i, j] ** 2
        if off**2 > BENT**2 * variance + (NARROWEST * size[i]) ** 2:
            return -1
    for i in range(m):
        off = y[i] - to_y[i]
        for j in range(n):
            off -= H[i, j] * (z[j] - from_z[j])
        variance = 0.0
        for j in range(width):
            variance += Y[i, j] ** 2
        if off**2 > BENT**2 * variance + (NARROWEST * abs(y[i])) ** 2:
            return -1
    return width


@njit(cache=True, error_model="numpy")
def straight(  # type: ignore[no-untyped-def]
    I, W, buffer, base_I, base_W, places, shown, noisy, probed, t, phi, sd, z, D, columns, y, width, Y, reach, aside,
    drawn,
):  # fmt: skip
    """Return whether signals follow their slopes over ``reach`` standard deviations: a limit near by bends them."""
    n, moved = len(z), np.empty(len(y))
    for i in range(len(y)):
        variance = 0.0
        for j in range(width):
            variance += Y[i, j] ** 2
        if not probed[i] or variance == 0.0:
            continue
        for way in (reach, -reach):
            far = way / math.sqrt(variance)
            for p in range(n):
                aside[p] = z[p]
                for j in range(columns):
                    aside[p] += far * D[p, j] * Y[i, j]
            c = columns
            for j in range(len(noisy)):
                drawn[j] = 0.0
                if sd[j] > 0.0:
                    drawn[j] = far * sd[j] * Y[i, c]
                    c += 1
            if arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, aside, drawn) != 0:
                return False
            read(W, shown, moved)
            off = moved[i] - y[i] - way * math.sqrt(variance)
            if off**2 > KINKED**2 * variance:
                return False
    return True


@njit(cache=True, error_model="numpy")
def joint(D, columns, sd, width, bends):  # type: ignore[no-untyped-def]
    """Return the factor of the state that a stretch left from, of what is drawn at its end, and of the bend."""
    n, q = len(D), len(sd)
    F = np.zeros((n + q + 1, D.shape[1]))
    F[:n, :columns] = D[:, :columns]
    c = columns
    for j in range(q):
        if sd[j] > 0.0:
            F[n + j, c] = sd[j]
            c += 1
    if bends:
        F[n + q, width - 1] = 1.0
    return F


@njit(cache=True, nogil=True, error_model="numpy")
def extended(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, shown, noisy, at, size, times, row_of, phi, sd, values, r,
    probed, z, spread, which, force, gains, kinks, at_rows, e, S,
):  # fmt: skip
    """Filter a log; write innovations ``e`` of unit variance and their variances ``S``, (rows, m); return a status.

    ``kept`` integers and ``saved`` floats make a run; ``places`` (n,) of the state, ``shown`` (m,) of logged signals,
    ``noisy`` (q,) of the noises in force, which stand ``at`` (q,) in the state; ``size`` (n,) of states.
    ``times`` (k,) of the stops [s], ``row_of`` the row of the log there, -1 for none; ``phi``, ``sd`` (k, q) how much
    of a noise stays at a stop, and the standard deviation of what is drawn.  ``values`` (rows, m), ``r`` (m,) variance
    of rounding; ``probed`` which signals are asked whether they bend.  ``z`` (n,), ``spread`` (n, columns): the state
    before the first stop, and a factor of its variance.

    Written are the noise that was in ``force`` before each stop (k, q), what the mean shows ``at_rows``, the ``gains``
    (rows, 2 n + m + q + 1, m) of the state, of signals, of the state one stop before, of what was drawn since and of
    the bend, the latter three only at rows with ``kinks``: these are run again with what each signal says.  Returned
    behind the status are pools of slopes ``A`` (i, n, n), ``B`` (i, n, q + 1), ``H`` (i, m, n), ``G`` (i, m, q + 1):
    those of stop k stand at ``which[k]``.
    """
    n, m, q = len(places), len(shown), len(noisy)
    no_rows, nothing = np.empty((1, 0)), np.full(m, np.nan)
    base_I, base_W = I[:kept].copy(), W[:saved].copy()
    next_I, next_W = I[:kept].copy(), W[:saved].copy()
    stop_I, stop_W = I[:kept].copy(), W[:saved].copy()
    room = FACTOR * (n + q + 1)
    D, E, Y = np.empty((n, room)), np.empty((n, room)), np.empty((m, room))
    columns = spread.shape[1]
    D[:, :columns] = spread
    at_stop, behind, y = np.empty(n), np.empty(n), np.empty(m)
    kinds, known = np.zeros((KINDS, I[N_BLOCKS]), dtype=np.int64), np.full(KINDS, -1)
    from_z, to_z, to_y = np.empty((KINDS, n)), np.empty((KINDS, n)), np.empty((KINDS, m))
    A, B = np.empty((KINDS, n, n)), np.empty((KINDS, n, q + 1))
    H, G = np.empty((KINDS, m, n)), np.empty((KINDS, m, q + 1))
    aside, drawn, back, nowhere = np.empty(n), np.empty(q), np.empty(n + q + 1), np.empty((0, room))
    count, status = 0, 0
    for k in range(len(times)):
        restore(I, W, base_I, base_W)
        put(I, W, places, z)
        status = arrive(I, W, buffer, no_rows, times[k])
        if status != 0:
            break
        for j in range(q):
            force[k, j] = W[noisy[j]]
            W[noisy[j]] *= phi[k, j]
        stop_I[:], stop_W[:] = I[:kept], W[:saved]
        read(W, places, at_stop)
        status = pass_instant(I, W, buffer, no_rows)
        if status != 0:
            break
        next_I[:], next_W[:] = I[:kept], W[:saved]
        read(W, places, behind)
        read(W, shown, y)
        columns = narrowed(D, columns, size, q)
        slot = same_kind(base_I, next_I, kinds, known, times, phi, sd, k)
        width = -1
        if slot >= 0 and known[slot] >= 0:
            i = which[known[slot]]
            width = foretold(A[i], B[i], H[i], G[i], sd[k], D, columns, E, Y, z, behind, y,
                             from_z[slot], to_z[slot], to_y[slot], size)  # fmt: skip
            which[k] = i
            if width >= 0 and not straight(I, W, buffer, base_I, base_W, places, shown, noisy, probed, times[k], phi[k],
                                           sd[k], z, D, columns, y, width, Y, WIDE, aside, drawn):  # fmt: skip
                width = -1
        if width < 0:
            A, B, H, G = with_room(A, count), with_room(B, count), with_room(H, count), with_room(G, count)
            status = slopes_at(
                I, W, buffer, base_I, base_W, stop_I, stop_W, places, shown, noisy, at, size, times[k], phi[k], sd[k],
                z, at_stop, D, columns, behind, y, A[count], B[count], H[count], G[count],
            )  # fmt: skip
            if status != 0:
                break
            width = spread_to(A[count], B[count], H[count], G[count], sd[k], D, columns, E, Y)
            which[k] = count
            count += 1
            if slot >= 0 and not bent(B[which[k]], G[which[k]]):
                known[slot] = k
                from_z[slot], to_z[slot], to_y[slot] = z, behind, y
        row = row_of[k]
        if row >= 0:
            at_rows[row] = y
            back[:n], back[n:] = z, 0.0
            F = nowhere
            kinks[row] = not straight(I, W, buffer, base_I, base_W, places, shown, noisy, probed, times[k], phi[k],
                                      sd[k], z, D, columns, y, width, Y, FAR, aside, drawn)  # fmt: skip
            if kinks[row]:
                F = joint(D, columns, sd[k], width, bent(B[which[k]], G[which[k]]))
            before = values[row - 1] if row > 0 else nothing
            z[:] = behind
            for i in range(m):
                took = taken_in(i, values[row, i], before[i], r[i], width, E, F, Y, z, back, y, gains[row], e[row],
                                S[row])  # fmt: skip
                if took and kinks[row]:
                    status = arrived(I, W, buffer, base_I, base_W, places, noisy, times[k], phi[k], back[:n],
                                     back[n : n + q])  # fmt: skip
                    if status != 0:
                        break
                    next_I[:], next_W[:] = I[:kept], W[:saved]
                    read(W, places, z)
                    read(W, shown, y)
                    z += back[n + q] * B[which[k], :, q]
                    y += back[n + q] * G[which[k], :, q]
            if status != 0:
                break
        else:
            z[:] = behind
        D, E, columns = E, D, width
        base_I[:], base_W[:] = next_I, next_W
    return status, A[:count].copy(), B[:count].copy(), H[:count].copy(), G[:count].copy()


@njit(cache=True, nogil=True, error_model="numpy")
def otherwise(  # type: ignore[no-untyped-def]
    at, size, row_of, phi, other_phi, other_sd, values, r, spread, which, force, A, B, H, G, shown, missed, gains,
    other_gains, e, S,
):  # fmt: skip
    """Filter a log with other noise along the path of a known filter, in its slopes: see ``extended``.

    ``phi``, ``force`` and ``gains`` are those of the known filter; ``shown`` (rows, m) what its mean showed at rows,
    and ``missed`` what it missed there.
    """
    n, m, q = A.shape[1], values.shape[1], len(at)
    room = FACTOR * (n + q + 1)
    D, E, Y = np.empty((n, room)), np.empty((n, room)), np.empty((m, room))
    columns = spread.shape[1]
    D[:, :columns] = spread
    nowhere, back = np.empty((0, room)), np.empty(0)
    a, h = np.empty((n, n)), np.empty((m, n))
    aside, moved, y, known = np.zeros(n), np.empty(n), np.empty(m), np.empty(m)
    for k in range(len(row_of)):
        i_k = which[k]
        a[:], h[:] = A[i_k], H[i_k]
        b, g = B[i_k], G[i_k]
        for j in range(q):
            more = other_phi[k, j] - phi[k, j]
            for i in range(n):
                a[i, at[j]] += more * b[i, j]
            for i in range(m):
                h[i, at[j]] += more * g[i, j]
        columns = narrowed(D, columns, size, q)
        width = spread_to(a, b, h, g, other_sd[k], D, columns, E, Y)
        for i in range(n):
            s = 0.0
            for j in range(n):
                s += a[i, j] * aside[j]
            for j in range(q):
                s += (other_phi[k, j] - phi[k, j]) * b[i, j] * force[k, j]
            moved[i] = s
        row = row_of[k]
        if row >= 0:
            for i in range(m):
                s = shown[row, i]
                for j in range(n):
                    s += h[i, j] * aside[j]
                for j in range(q):
                    s += (other_phi[k, j] - phi[k, j]) * g[i, j] * force[k, j]
                y[i] = s
            known[:] = shown[row]
            for i in range(m):
                if values[row, i] != values[row, i]:
                    continue
                off = missed[row, i]
                if off == off:  # where a row was run again, it missed other than its slopes foretell: so would this one
                    y[i] += values[row, i] - known[i] - off
                before = values[row - 1, i] if row > 0 else math.nan
                taken_in(i, values[row, i], before, r[i], width, E, nowhere, Y, moved, back, y, other_gains[row],
                         e[row], S[row])  # fmt: skip
                if off == off:
                    for p in range(n):
                        moved[p] -= gains[row, p, i] * off
                    for p in range(m):
                        known[p] += gains[row, n + p, i] * off
        aside[:] = moved
        D, E, columns = E, D, width
