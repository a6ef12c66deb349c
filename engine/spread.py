"""The spread of a state: its factor, what a row of a log says of it, and what bends.

    D = [A L, B sd sqrt(1 - phi^2), b]        Y = [H L, G sd sqrt(1 - phi^2), g]        P = L L', P' = D D'

b, g: the root of the mean square of what slopes leave, which is c^2 / 12 where c = f(+) + f(-) - 2 f(0) at sqrt 3
standard deviations.  The mean of what comes out is f(0) + c / 6: noise drags a stem further than the mean of OP does.
Source: Potter's square root form (Maybeck, Stochastic Models, Estimation and Control 1 (1979), section 7.3); second
differences in mean and spread as in Norgaard, Poulsen and Ravn, Automatica 36 (2000), section 4.
"""

import math

import numpy as np
from stickslip.logs.compiled import njit

SHARP = 12.0  # mean square of b x^2 is c^2 / 12, where c = f(+) + f(-) - 2 f(0) sqrt 3 standard deviations away
TURN = 6.0  # mean of b x^2 is c / 6, with the same c
DROPPED = 1e-13  # share of its size below which what is left of a state's variance is rounding
NARROWEST = 1e-7  # of a state's size: the least difference that shows a slope
BENT = 0.05  # share of its spread by which a stop may lie off the slopes of another that stand for its own
REORDERED = {"reassoc", "contract"}  # sums may be taken in the order that takes the least time
STALE = 0.1  # of the rounding's variance: a value that is surer, and is as foretold, says nothing


@njit(cache=True, error_model="numpy", fastmath=REORDERED)
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
                s -= L[i, j] * L[p, j]
            L[i, found] = s / root
            rest[i] -= L[i, found] ** 2
        rest[p] = -1.0
        found += 1
    for i in range(n):
        for j in range(found):
            L[i, j] *= size[i]
    return found


@njit(cache=True, error_model="numpy", inner=True)
def times(A, D, columns, E):  # type: ignore[no-untyped-def]
    """Write the product of slopes and the first ``columns`` of a factor to ``E``."""
    for i in range(len(A)):
        first = True
        for k in range(A.shape[1]):
            by = A[i, k]
            if by != 0.0:  # a dead time is a chain of states, each of which has one slope
                for j in range(columns):
                    E[i, j] = by * D[k, j] if first else E[i, j] + by * D[k, j]
                first = False
        for j in range(columns if first else 0):
            E[i, j] = 0.0


@njit(cache=True, error_model="numpy", inner=True)
def spread_to(A, B, H, G, sd, D, columns, E, Y):  # type: ignore[no-untyped-def]
    """Write the spread behind a stop, of the state to ``E`` and of signals to ``Y``; return how many columns it has."""
    q = len(sd)
    times(A, D, columns, E)
    times(H, D, columns, Y)
    width = columns
    for j in range(q + 1):  # the last is what bends
        by = sd[j] if j < q else 1.0
        if by > 0.0 and (j < q or bent(B, G)):
            for i in range(len(A)):
                E[i, width] = B[i, j] * by
            for i in range(len(H)):
                Y[i, width] = G[i, j] * by
            width += 1
    return width


@njit(cache=True, error_model="numpy")
def bent(B, G):  # type: ignore[no-untyped-def]
    """Return whether slopes have a bend; the last column is its size."""
    q = B.shape[1] - 1
    found = False
    for i in range(len(B)):
        found = found or B[i, q] != 0.0
    for i in range(len(G)):
        found = found or G[i, q] != 0.0
    return found


@njit(cache=True, error_model="numpy")
def narrowed(D, columns, size, q):  # type: ignore[no-untyped-def]
    """Write a factor ``D`` with fewer columns where it has no room for those of ``q`` noises; return how many."""
    if columns + q + 1 <= D.shape[1]:
        return columns
    L = np.empty((len(D), len(D)))
    columns = compressed(D, columns, size, L)
    for i in range(len(D)):
        for j in range(columns):
            D[i, j] = L[i, j]
    return columns


@njit(cache=True, error_model="numpy", inner=True)
def with_room(pool, count):  # type: ignore[no-untyped-def]
    """Return a pool of slopes that has room for one more."""
    return pool if count < len(pool) else first_of(pool, count, 2 * count)


@njit(cache=True, error_model="numpy", inner=True)
def first_of(pool, count, room):  # type: ignore[no-untyped-def]
    """Return a pool with the first ``count`` slopes of another, and ``room`` for so many."""
    found = np.empty((room, pool.shape[1], pool.shape[2]))
    for i in range(count):
        for p in range(pool.shape[1]):
            for j in range(pool.shape[2]):
                found[i, p, j] = pool[i, p, j]
    return found


@njit(cache=True, error_model="numpy", inner=True, fastmath=REORDERED)
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
    own = np.empty(width)
    for j in range(width):
        own[j] = Y[i, j]
    set_right(E, own, width, s, off, less, z, gains[:n, i])
    set_right(Y, own, width, s, off, less, y, gains[n : n + m, i])
    set_right(F, own, width, s, off, less, back, gains[n + m :, i])
    return True


@njit(cache=True, error_model="numpy", inner=True, fastmath=REORDERED)
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


@njit(cache=True, error_model="numpy", inner=True)
def add_bend(  # type: ignore[no-untyped-def]
    up, down, middle, y_up, y_down, y_middle, bend, y_bend, turn, most, way, y_way
):
    """Add the squares of what slopes leave to both sides; keep the ``way`` of the largest; return its size.

    ``turn`` gathers by how much the mean of what comes out differs from what the mean comes to, signals last.
    """
    total, n = 0.0, len(bend)
    for i in range(n):
        c = up[i] + down[i] - 2.0 * middle[i]
        bend[i] += c**2
        turn[i] += c / TURN
    for i in range(len(y_bend)):
        c = y_up[i] + y_down[i] - 2.0 * y_middle[i]
        y_bend[i] += c**2
        turn[n + i] += c / TURN
        total += c**2
    if total > most:
        for i in range(len(bend)):
            way[i] = up[i] + down[i] - 2.0 * middle[i]
        for i in range(len(y_bend)):
            y_way[i] = y_up[i] + y_down[i] - 2.0 * y_middle[i]
        return total
    return most


@njit(cache=True, error_model="numpy", inner=True)
def one_bend(A, H, B, G, sd, D, columns, bend, y_bend):  # type: ignore[no-untyped-def]
    """Make one column of what bends, with the signs of the largest; none where it is a small part of the spread."""
    n, m, q = len(A), len(H), len(sd)
    shows = matters(A, B, sd, D, columns, bend) or matters(H, G, sd, D, columns, y_bend)
    for i in range(n):
        B[i, q] = math.copysign(math.sqrt(bend[i] / SHARP), B[i, q]) if shows else 0.0
    for i in range(m):
        G[i, q] = math.copysign(math.sqrt(y_bend[i] / SHARP), G[i, q]) if shows else 0.0


@njit(cache=True, error_model="numpy", inner=True)
def matters(A, B, sd, D, columns, bend):  # type: ignore[no-untyped-def]
    """Return whether what bends is more than a small part of the spread of anything."""
    for i in range(len(A)):
        variance = 0.0
        for j in range(columns):
            s = 0.0
            for k in range(A.shape[1]):
                s += A[i, k] * D[k, j]
            variance += s * s
        for j in range(len(sd)):
            variance += (B[i, j] * sd[j]) ** 2
        if bend[i] / SHARP > BENT**2 * variance:
            return True
    return False


@njit(cache=True, error_model="numpy")
def foretold(A, B, H, G, sd, D, columns, E, Y, z, behind, y, from_z, to_z, to_y, size):  # type: ignore[no-untyped-def]
    """Return how many columns the spread has by slopes of another stop; -1 if they do not foretell this one.

    They do if they miss it by a small part of its spread at most.
    """
    width = spread_to(A, B, H, G, sd, D, columns, E, Y)
    aside = z - from_z
    if foretells(A, aside, behind, to_z, E, width, BENT, NARROWEST, size) and foretells(
        H, aside, y, to_y, Y, width, BENT, NARROWEST, np.abs(y)
    ):
        return width
    return -1


@njit(cache=True, error_model="numpy", fastmath=REORDERED)
def foretells(A, aside, now, then, E, width, share, least, size):  # type: ignore[no-untyped-def]
    """Return whether slopes of another run, so far ``aside``, miss what is ``now`` by a ``share`` of its spread only.

    ``least`` share of its ``size`` that may be missed where nothing is spread.
    """
    for i in range(len(now)):
        off = now[i] - then[i]
        for j in range(len(aside)):
            off -= A[i, j] * aside[j]
        variance = 0.0
        for j in range(width):
            variance += E[i, j] ** 2
        if off**2 > share**2 * variance + (least * size[i]) ** 2:
            return False
    return True


@njit(cache=True, error_model="numpy")
def joint(D, columns, sd, width, bends):  # type: ignore[no-untyped-def]
    """Return the factor of the state that a stretch left from, of what is drawn at its end, and of the bend."""
    n, q = len(D), len(sd)
    F = np.zeros((n + q + 1, D.shape[1]))
    for i in range(n):
        for j in range(columns):
            F[i, j] = D[i, j]
    c = columns
    for j in range(q):
        if sd[j] > 0.0:
            F[n + j, c] = sd[j]
            c += 1
    if bends:
        F[n + q, width - 1] = 1.0
    return F
