"""Slopes of what a stretch of a run and the stop behind it make of a state: differences across the run itself."""

import math

import numpy as np
from stickslip.engine.layout import COUNT, EVENTS, R
from stickslip.engine.layout import H as H0
from stickslip.engine.restarts import arrive, pass_instant, put, read, restore, write
from stickslip.engine.spread import NARROWEST, add_bend, bent, foretells, one_bend
from stickslip.logs.compiled import njit

WIDE = math.sqrt(3.0)
SAME = 1e-6  # share by which noise of two stops of one kind may differ: instants are rounded
ROUNDED = 1e-9  # of its size: what differs by less is equal
STEEP = 0.008  # share of the spread by which runs to both sides may miss slopes of another stop
SIGNS = 8  # stops after which signs repeat
KINKED = 0.5  # standard deviations by which signals may miss their slopes over all that is likely


@njit(cache=True, error_model="numpy", inner=True)
def arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, z, drawn):  # type: ignore[no-untyped-def]
    """Run from a state ``z`` past an instant, where noise goes on and is ``drawn``; return a status."""
    restore(I, W, base_I, base_W)
    put(I, W, places[0], z)
    status = arrive(I, W, buffer, t)
    if status != 0:
        return status
    for j in range(len(noisy)):
        W[noisy[j]] = W[noisy[j]] * phi[j] + drawn[j]
    return pass_instant(I, W, buffer)


@njit(cache=True, error_model="numpy")
def slopes_at(  # type: ignore[no-untyped-def]
    I, W, buffer, base_I, base_W, stop_I, stop_W, places, shown, noisy, at, size, t, phi, sd, z, at_stop, D, columns,
    behind, y, A, B, H, G, turn, passed_on,
):  # fmt: skip
    """Write the slopes of what a stretch and the stop behind it make of the state, and of a noise drawn there.

    ``passed_on`` (n,): where a state goes that does nothing else, as in a dead time; -1 for others, or if unknown.

    The last columns of ``B`` and ``G`` are what bends: the root of the mean square of what slopes leave.  ``turn``
    (n + m,) is by how much that moves the mean of the state, and of the signals.
    """
    n, m, q = places.shape[1], len(shown), len(noisy)
    bend, y_bend, most, moves = np.zeros(n), np.zeros(m), 0.0, False
    for i in range(n + m):
        turn[i] = 0.0
    clear(B, q)
    clear(G, q)
    up, down, y_up, y_down, moved_z = np.empty(n), np.empty(n), np.empty(m), np.empty(m), np.empty(n)
    nothing, fars = np.zeros(q), np.empty(n)
    for i in range(n):
        variance = 0.0
        for j in range(columns):
            variance += D[i, j] ** 2
        fars[i] = WIDE * max(math.sqrt(variance), NARROWEST * size[i])
        moves = moves or passed_on[i] >= 0
    together = False
    if moves:  # these move at once, if they still do nothing else
        for i in range(n):
            moved_z[i] = z[i] + (fars[i] if passed_on[i] >= 0 else 0.0)
        status = arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, moved_z, nothing)
        if status != 0:
            return status
        read(W, places[1], up)
        read(W, shown, y_up)
        write(behind, down)
        for i in range(n):
            if passed_on[i] >= 0:
                down[passed_on[i]] += fars[i]
        together = near(up, down, size) and near(y_up, y, y)
    for i in range(n):
        far = fars[i]
        if together and passed_on[i] >= 0:
            clear(A, i)
            clear(H, i)
            A[passed_on[i], i] = 1.0
            continue
        for way in range(2):
            write(z, moved_z)
            moved_z[i] += far if way == 0 else -far
            status = arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, moved_z, nothing)
            if status != 0:
                return status
            read(W, places[1], up if way == 0 else down)
            read(W, shown, y_up if way == 0 else y_down)
        slope(up, down, far, A, i)
        slope(y_up, y_down, far, H, i)
        most = add_bend(up, down, behind, y_up, y_down, y, bend, y_bend, turn, most, B[:, q], G[:, q])
    for j in range(len(noisy)):
        clear(B, j)
        clear(G, j)
        if sd[j] > 0.0:
            far = WIDE * sd[j]
            for way in range(2):
                restore(I, W, stop_I, stop_W)
                W[noisy[j]] = at_stop[at[j]] + (far if way == 0 else -far)
                status = pass_instant(I, W, buffer)
                if status != 0:
                    return status
                read(W, places[1], up if way == 0 else down)
                read(W, shown, y_up if way == 0 else y_down)
            slope(up, down, far, B, j)
            slope(y_up, y_down, far, G, j)
            most = add_bend(up, down, behind, y_up, y_down, y, bend, y_bend, turn, most, B[:, q], G[:, q])
    one_bend(A, H, B, G, sd, D, columns, bend, y_bend)
    for i in range(0 if bent(B, G) else n + m):
        turn[i] = 0.0
    return 0


@njit(cache=True, error_model="numpy", inner=True)
def clear(A, j):  # type: ignore[no-untyped-def]
    """Let column ``j`` be 0."""
    for i in range(len(A)):
        A[i, j] = 0.0


@njit(cache=True, error_model="numpy", inner=True)
def slope(up, down, far, A, j):  # type: ignore[no-untyped-def]
    """Write to column ``j`` how fast changes what is ``up`` so ``far`` to one side, and ``down`` to the other."""
    for i in range(len(up)):
        A[i, j] = (up[i] - down[i]) / (2.0 * far)


@njit(cache=True, error_model="numpy", inner=True)
def near(one, other, size):  # type: ignore[no-untyped-def]
    """Return whether two differ by rounding alone."""
    alike = True
    for i in range(len(one)):
        alike = alike and abs(one[i] - other[i]) <= ROUNDED * abs(size[i])
    return alike


@njit(cache=True, error_model="numpy", inner=True)
def passing_on(A, H):  # type: ignore[no-untyped-def]
    """Return where each state goes that does nothing else, (n,); -1 for others."""
    n = len(A)
    found, taken = np.full(n, -1), np.zeros(n, dtype=np.bool_)
    for i in range(n):
        to = -1
        for k in range(n):
            if A[k, i] != 0.0:
                to = k if to == -1 and abs(A[k, i] - 1.0) <= ROUNDED else -2
        shown = False
        for k in range(len(H)):
            shown = shown or H[k, i] != 0.0
        if to >= 0 and not taken[to] and not shown:
            found[i], taken[to] = to, True
    return found


@njit(cache=True, error_model="numpy", inner=True)
def same_kind(base, behind, floats, after, modes, kinds, known, times, phi, sd, k):  # type: ignore[no-untyped-def]
    """Return the slot of stops like this one, by what sampled and switched on the way; -1 for none left.

    ``floats`` from which the stretch left, ``after`` it; ``modes`` where they hold modes and counts.
    """
    if k == 0:
        return -1
    n_blocks = kinds.shape[1] - 2 * len(modes) - 1
    this = np.empty(kinds.shape[1], dtype=np.int64)
    for b in range(n_blocks):
        this[b] = behind[H0 + b * R + COUNT] - base[H0 + b * R + COUNT]
    for i in range(len(modes)):
        this[n_blocks + 2 * i], this[n_blocks + 2 * i + 1] = int(floats[modes[i]]), int(after[modes[i]])
    this[n_blocks + 2 * len(modes)] = behind[EVENTS] - base[EVENTS]
    for slot in range(len(known)):
        if known[slot] < 0:
            write(this, kinds[slot])
            return slot
        other = known[slot]
        alike = abs((times[k] - times[k - 1]) - (times[other] - times[other - 1])) < 1e-9 * times[k]
        for j in range(phi.shape[1]):
            alike = alike and abs(phi[k, j] - phi[other, j]) < SAME and abs(sd[k, j] - sd[other, j]) <= SAME * sd[k, j]
        for i in range(len(this)):
            alike = alike and kinds[slot, i] == this[i]
        if alike:
            return slot
    return -1


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


@njit(cache=True, error_model="numpy", inner=True)
def as_steep(  # type: ignore[no-untyped-def]
    I, W, buffer, base_I, base_W, places, shown, noisy, t, phi, sd, k, A, B, H, G, z, D, columns, behind, y, E, Y,
    width, aside, drawn,
):  # fmt: skip
    """Return whether slopes of another stop are those of stop ``k``: runs to both sides of it end where they say.

    All that is not known moves at once, with signs that change from stop to stop, so nothing hides for long.
    """
    n, m, q = len(z), len(y), len(noisy)
    step, to, to_y = np.zeros(n), np.empty(n), np.empty(m)
    by, then, then_y = np.empty(n), np.empty(n), np.empty(m)
    for j in range(columns):
        sign = 1.0 if (k >> (j % SIGNS)) & 1 else -1.0
        for i in range(n):
            step[i] += sign * D[i, j]
    for way in (WIDE, -WIDE):
        for i in range(n):
            by[i] = way * step[i]
            aside[i] = z[i] + by[i]
        for j in range(q):
            drawn[j] = way * sd[j]
        if arrived(I, W, buffer, base_I, base_W, places, noisy, t, phi, aside, drawn) != 0:
            return False
        read(W, places[1], to)
        read(W, shown, to_y)
        drawn_to(behind, B, drawn, then)
        drawn_to(y, G, drawn, then_y)
        if not foretells(A, by, to, then, E, width, STEEP, 0.0, z):
            return False
        if not foretells(H, by, to_y, then_y, Y, width, STEEP, 0.0, y):
            return False
    return True


@njit(cache=True, error_model="numpy", inner=True)
def noted(z, behind, y, from_z, to_z, to_y):  # type: ignore[no-untyped-def]
    """Note from where a stop was reached, and what it came to."""
    write(z, from_z)
    write(behind, to_z)
    write(y, to_y)


@njit(cache=True, error_model="numpy", inner=True)
def drawn_to(of, B, drawn, found):  # type: ignore[no-untyped-def]
    """Write as ``found`` what becomes of a stop once noise is ``drawn`` there."""
    for i in range(len(of)):
        found[i] = of[i]
        for j in range(len(drawn)):
            found[i] += B[i, j] * drawn[j]
