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
from stickslip.engine.layout import N_BLOCKS
from stickslip.engine.restarts import add, arrive, begin, keep, pass_instant, put, read, restore, write
from stickslip.engine.slopes import WIDE, arrived, as_steep, noted, passing_on, same_kind, slopes_at, straight
from stickslip.engine.spread import bent, first_of, foretold, joint, narrowed, spread_to, taken_in, with_room
from stickslip.engine.status import Status
from stickslip.logs.compiled import njit

FACTOR = 2  # columns of the spread's factor, over what is needed at least: more of them, and it is narrowed less often
FAR = 4.0  # standard deviations within which a row may find the state
LOST = 8.0  # standard deviations by which a row is missed from where on the spread is no guide to what bends
KINDS = 24  # of stops whose slopes are kept
TOO_MANY = int(Status.TOO_MANY_STEPS)
BEHIND = 2**30  # status of a filter that was given up


@njit(cache=True, nogil=True, error_model="numpy")
def followed(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, shown, noisy, times, row_of, phi, values, gains, kinks, turns, z, at_rows,
    missed,
):  # fmt: skip
    """Follow the mean alone, set right by known ``gains`` and ``turns`` (see ``extended``); ``kinks``: rows run again.

    Written are what the mean shows ``at_rows``, and what each signal ``missed`` once those before it are known.
    """
    n, m, q = places.shape[1], len(shown), len(noisy)
    y, back = np.empty(m), np.zeros(n + q)
    base_I, base_W = np.empty(kept, dtype=np.int64), np.empty(saved)
    for k in range(len(times)):
        row = row_of[k]
        again = row >= 0 and kinks[row]
        if again:
            keep(I, W, base_I, base_W)
            begin(z, back)
        put(I, W, places[0], z)
        status = arrive(I, W, buffer, times[k])
        if status != 0:
            return status
        for j in range(q):
            W[noisy[j]] *= phi[k, j]
        status = pass_instant(I, W, buffer)
        if status != 0:
            return status
        read(W, places[1], z)
        add(turns[k], 0, z)
        if row < 0:
            continue
        read(W, shown, y)
        add(turns[k], n, y)
        write(y, at_rows[row])
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
                read(W, places[1], z)
                read(W, shown, y)
                add(turns[k], 0, z)
                add(turns[k], n, y)
    return 0


@njit(cache=True, error_model="numpy", inner=True)
def huber(off, far):  # type: ignore[no-untyped-def]
    """Return the loss of a value ``off`` by so many standard deviations [nats], in proportion beyond ``far``."""
    size = abs(off)
    near = min(size, far)
    return 0.5 * near * near + far * (size - near)


@njit(cache=True, nogil=True, error_model="numpy", inner=True)
def loss_of(e, S, sure, far):  # type: ignore[no-untyped-def]
    """Return the loss of the values of one row [nats]; ``sure`` (m,) is that of a value without variance."""
    loss = 0.0
    for i in range(len(e)):
        if S[i] == S[i]:
            loss += huber(e[i], far) + 0.5 * math.log(S[i])
        else:
            loss += sure[i]
    return loss


@njit(cache=True, nogil=True, error_model="numpy")
def extended(  # type: ignore[no-untyped-def]
    I, W, buffer, kept, saved, places, modes, shown, noisy, at, size, times, row_of, phi, sd, values, r,
    probed, joined, most, bar, sure, far, z, spread, which, force, gains, kinks, turns, at_rows, e, S,
):  # fmt: skip
    """Filter a log; write innovations ``e`` of unit variance and their variances ``S``, (rows, m); return a status.

    ``kept`` integers and ``saved`` floats make a run; ``places`` (2, n) where the state is set and where it is
    read, ``modes`` (any,) of modes and counts, ``shown`` (m,) of logged signals,
    ``noisy`` (q,) of the noises in force, which stand ``at`` (q,) in the state; ``size`` (n,) of states.
    ``times`` (k,) of the stops [s], ``row_of`` the row of the log there, -1 for none; ``phi``, ``sd`` (k, q) how much
    of a noise stays at a stop, and the standard deviation of what is drawn.  ``values`` and ``r`` (rows, m), the
    variance of rounding; ``probed`` which signals are asked whether they bend; ``joined`` whether every row has all
    gains, not only those near a kink; ``most`` stops that may have slopes of their own; ``bar`` (rows,) the sum of
    losses at which it is given up, NaN where a row does not count, (0,) for never, with ``sure`` (m,) and ``far`` of
    ``loss_of``.
    ``z`` (n,), ``spread`` (n, columns): the state before the first stop, and a factor of its variance.

    Written are the noise that was in ``force`` before each stop (k, q), what the mean shows ``at_rows``, the ``gains``
    (rows, 2 n + m + q + 1, m) of the state, of signals, of the state one stop before, of what was drawn since and of
    the bend, the latter three only at rows with ``kinks``: these are run again with what each signal says; ``turns``
    (k, n + m) by how much a bend moves the mean of the state, and of the signals.  Returned
    behind the status are pools of slopes ``A`` (i, n, n), ``B`` (i, n, q + 1), ``H`` (i, m, n), ``G`` (i, m, q + 1):
    those of stop k stand at ``which[k]``.
    """
    n, m, q = places.shape[1], len(shown), len(noisy)
    base_I, base_W = np.empty(kept, dtype=np.int64), np.empty(saved)
    next_I, next_W = np.empty(kept, dtype=np.int64), np.empty(saved)
    stop_I, stop_W = np.empty(kept, dtype=np.int64), np.empty(saved)
    keep(I, W, base_I, base_W)
    room = FACTOR * (n + q + 1)
    D, E, Y = np.empty((n, room)), np.empty((n, room)), np.empty((m, room))
    columns = spread.shape[1]
    for i in range(n):
        write(spread[i], D[i])
    at_stop, behind, y = np.empty(n), np.empty(n), np.empty(m)
    kinds, known = np.zeros((KINDS, I[N_BLOCKS] + 2 * len(modes) + 1), dtype=np.int64), np.full(KINDS, -1)
    from_z, to_z, to_y = np.empty((KINDS, n)), np.empty((KINDS, n)), np.empty((KINDS, m))
    A, B = np.empty((KINDS, n, n)), np.empty((KINDS, n, q + 1))
    H, G = np.empty((KINDS, m, n)), np.empty((KINDS, m, q + 1))
    alone = np.full(n, -1)
    aside, drawn, back, nowhere = np.empty(n), np.empty(q), np.empty(n + q + 1), np.empty((0, room))
    count, status, near, lost, moved, loss = 0, 0, True, False, False, 0.0
    for k in range(len(times)):
        if moved:  # other runs have left the same instant since
            restore(I, W, base_I, base_W)
            moved = False
        put(I, W, places[0], z)
        status = arrive(I, W, buffer, times[k])
        if status != 0:
            break
        for j in range(q):
            force[k, j] = W[noisy[j]]
            W[noisy[j]] *= phi[k, j]
        read(W, places[1], at_stop)
        status = pass_instant(I, W, buffer)
        if status != 0:
            break
        read(W, places[1], behind)
        read(W, shown, y)
        columns = narrowed(D, columns, size, q)
        slot = same_kind(base_I, I, base_W, W, modes, kinds, known, times, phi, sd, k)
        width, like = -1, which[known[slot]] if slot >= 0 and known[slot] >= 0 else -1  # slopes of a stop of its kind
        if like >= 0:
            width = foretold(A[like], B[like], H[like], G[like], sd[k], D, columns, E, Y, z, behind, y,
                             from_z[slot], to_z[slot], to_y[slot], size)  # fmt: skip
            which[k] = like
        row = row_of[k]
        moved = row >= 0 or width < 0 or near  # no other stop is probed, or has slopes of its own
        if moved:
            keep(I, W, next_I, next_W)
        borrowed = width < 0 and like >= 0 and not near
        if borrowed:  # an input has moved the run, which may leave it as steep
            width = spread_to(A[like], B[like], H[like], G[like], sd[k], D, columns, E, Y)
            if as_steep(I, W, buffer, base_I, base_W, places, shown, noisy, times[k], phi[k], sd[k], k, A[like],
                        B[like], H[like], G[like], z, D, columns, behind, y, E, Y, width, aside, drawn):  # fmt: skip
                noted(z, behind, y, from_z[slot], to_z[slot], to_y[slot])
            else:
                width = -1
        # between rows nothing bends within the spread, if it did not within more of it at the row before
        bends = width >= 0 and (row >= 0 or near or borrowed) and not straight(
            I, W, buffer, base_I, base_W, places, shown, noisy, probed, times[k], phi[k], sd[k], z, D, columns, y,
            width, Y, FAR if row >= 0 else WIDE, aside, drawn,
        )  # fmt: skip
        if bends and (row < 0 or not straight(
            I, W, buffer, base_I, base_W, places, shown, noisy, probed, times[k], phi[k], sd[k], z, D, columns, y,
            width, Y, WIDE, aside, drawn,
        )):  # fmt: skip
            width = -1
        fresh = width < 0
        if fresh:
            if count == most:
                status = TOO_MANY
                break
            restore(I, W, base_I, base_W)
            put(I, W, places[0], z)
            status = arrive(I, W, buffer, times[k])
            if status != 0:
                break
            for j in range(q):
                W[noisy[j]] *= phi[k, j]
            keep(I, W, stop_I, stop_W)
            A, B, H, G = with_room(A, count), with_room(B, count), with_room(H, count), with_room(G, count)
            status = slopes_at(
                I, W, buffer, base_I, base_W, stop_I, stop_W, places, shown, noisy, at, size, times[k], phi[k], sd[k],
                z, at_stop, D, columns, behind, y, A[count], B[count], H[count], G[count], turns[k],
                passing_on(A[like], H[like]) if like >= 0 else alone,
            )  # fmt: skip
            if status != 0:
                break
            width = spread_to(A[count], B[count], H[count], G[count], sd[k], D, columns, E, Y)
            which[k] = count
            count += 1
            if slot >= 0 and not bent(B[which[k]], G[which[k]]):
                known[slot] = k
                noted(z, behind, y, from_z[slot], to_z[slot], to_y[slot])
            for p in range(n + m if lost else 0):
                turns[k, p] = 0.0
            add(turns[k], 0, behind)
            add(turns[k], n, y)
        if row >= 0:
            write(y, at_rows[row])
            begin(z, back)
            F = nowhere
            if fresh:
                bends = not straight(I, W, buffer, base_I, base_W, places, shown, noisy, probed, times[k], phi[k],
                                     sd[k], z, D, columns, y, width, Y, FAR, aside, drawn)  # fmt: skip
            kinks[row] = near = bends
            if kinks[row] or joined:
                F = joint(D, columns, sd[k], width, bent(B[which[k]], G[which[k]]))
            write(behind, z)
            for i in range(m):
                before = values[row - 1, i] if row > 0 else math.nan
                took = taken_in(i, values[row, i], before, r[row, i], width, E, F, Y, z, back, y, gains[row],
                                e[row], S[row])  # fmt: skip
                if took and kinks[row]:
                    status = arrived(I, W, buffer, base_I, base_W, places, noisy, times[k], phi[k], back[:n],
                                     back[n : n + q])  # fmt: skip
                    if status != 0:
                        break
                    keep(I, W, next_I, next_W)
                    read(W, places[1], z)
                    read(W, shown, y)
                    for p in range(n):
                        z[p] += back[n + q] * B[which[k], p, q] + turns[k, p]
                    for p in range(m):
                        y[p] += back[n + q] * G[which[k], p, q] + turns[k, n + p]
            if status != 0:
                break
            lost = False
            for i in range(m):
                lost = lost or abs(e[row, i]) > LOST
            if len(bar) > 0 and bar[row] == bar[row]:
                loss += loss_of(e[row], S[row], sure, far)
                if loss > bar[row]:
                    status = BEHIND
                    break
        else:
            write(behind, z)
        D, E, columns = E, D, width
        if moved:
            restore(base_I, base_W, next_I, next_W)
        else:
            keep(I, W, base_I, base_W)
    return (status, first_of(A, count, count), first_of(B, count, count), first_of(H, count, count),
            first_of(G, count, count))  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def otherwise(  # type: ignore[no-untyped-def]
    at, size, row_of, phi, other_phi, other_sd, values, r, joined, spread, which, force, A, B, H, G, shown, missed,
    gains, other_gains, e, S,
):  # fmt: skip
    """Filter a log with other noise along the path of a known filter, in its slopes: see ``extended``.

    ``phi``, ``force`` and ``gains`` are those of the known filter; ``shown`` (rows, m) what its mean showed at rows,
    and ``missed`` what it missed there; ``joined`` whether every row has all gains.
    """
    n, m, q = A.shape[1], values.shape[1], len(at)
    room = FACTOR * (n + q + 1)
    D, E, Y = np.empty((n, room)), np.empty((n, room)), np.empty((m, room))
    columns = spread.shape[1]
    for i in range(n):
        write(spread[i], D[i])
    nowhere, back = np.empty((0, room)), np.empty(n + q + 1)
    a, h = np.empty((n, n)), np.empty((m, n))
    aside, moved, y, known = np.zeros(n), np.empty(n), np.empty(m), np.empty(m)
    for k in range(len(row_of)):
        own = which[k]
        b, g = B[own], G[own]
        for i in range(n):
            write(A[own, i], a[i])
        for i in range(m):
            write(H[own, i], h[i])
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
            write(shown[row], known)
            F = joint(D, columns, other_sd[k], width, bent(b, g)) if joined else nowhere
            for i in range(m):
                if values[row, i] != values[row, i]:
                    continue
                off = missed[row, i]
                if off == off:  # where a row was run again, it missed other than its slopes foretell: so would this one
                    y[i] += values[row, i] - known[i] - off
                before = values[row - 1, i] if row > 0 else math.nan
                taken_in(i, values[row, i], before, r[row, i], width, E, F, Y, moved, back, y, other_gains[row],
                         e[row], S[row])  # fmt: skip
                if off == off:
                    for p in range(n):
                        moved[p] -= gains[row, p, i] * off
                    for p in range(m):
                        known[p] += gains[row, n + p, i] * off
        write(moved, aside)
        D, E, columns = E, D, width
