"""Filter a log with a scanned diagram: innovations of unit variance, and the likelihood of the log.

    at a row     e = (y - H z) / sqrt(s),   s = H P H' + r,   z += K sqrt(s) e        one signal after the other
    to the next  z = F z + ...,   P = F P F' + Q                                      scan by scan

    nll = 1/2 sum over rows and signals of (e^2 + ln s)                               up to a constant

r is the variance of the log's rounding, step^2 / 12.  Mean and covariance go through the law of the valve as its
first two moments say (``blurred``), or the covariance is steady where there is none (``steady``).  Near a limit of a
controller nobody knows whether it is reached.  What is wanted is N(w, sd^2): so OP is the mean of what lies within the
limits, its slope the share p that does, memories are the mean of both cases, and their variance grows by
p (1 - p) (their difference)^2.  Until it has settled again the covariance is carried along; so it is behind a row in
which a signal is missing.
"""

import math

import numpy as np
from stickslip.gap.filters.laws import STOPS, blurred, through, within
from stickslip.gap.filters.passing import CLOSE, along, clear, forecast, taken_in
from stickslip.logs.compiled import njit

SMALLEST = 1e-16  # variance
CERTAIN = 12.0 / (2.0 * math.pi)  # of r: variance of a normal law that is as dense as one over the rounding step
SETTLED = 0.02  # share by which variances may still differ from steady ones


@njit(cache=True)
def commanded(row, z, v, limits, period, offset, last, k, scans, free, wanted):  # type: ignore[no-untyped-def]
    """Write z and what each controller gives at scan ``k`` into ``row``; the last one reads those before it.

    ``scans``: which compute now, the others hold what they gave; ``free``: 1 for those at no limit, else 0; ``wanted``:
    what they would give without limits.
    """
    n, N = len(z), len(row)
    for i in range(n):
        row[i] = z[i]
    for i in range(n, n + len(v) + 1):
        row[i] = 0.0
    for c in range(len(v)):
        scans[c] = period[c] == 1 or (k - offset[c]) % period[c] == 0
        wanted[c] = 0.0
        if scans[c]:
            for i in range(N):
                wanted[c] += v[c, i] * row[i]
        else:
            wanted[c] = z[last[c]]
        row[n + c] = min(max(wanted[c], limits[c, 0]), limits[c, 1]) if scans[c] else wanted[c]
        free[c] = 1.0 if row[n + c] == wanted[c] else 0.0


@njit(cache=True)
def slopes(v, n, scans, free, last, shown):  # type: ignore[no-untyped-def]
    """Write how what each controller gives follows z, (controllers, n); ``free``: the share that is at no limit."""
    for c in range(len(v)):
        for i in range(n):
            shown[c, i] = v[c, i] if scans[c] else 0.0
        if not scans[c]:
            shown[c, last[c]] = 1.0
            continue
        for d in range(c):
            for i in range(n):
                shown[c, i] += v[c, n + d] * shown[d, i]
        for i in range(n):
            shown[c, i] *= free[c]


@njit(cache=True)
def deviation(h, P):  # type: ignore[no-untyped-def]
    """Return the standard deviation of what is seen through a row over z."""
    total = 0.0
    for i in range(len(h)):
        if h[i] != 0.0:
            total += h[i] * along(P[i], h)
    return math.sqrt(max(total, 0.0))


@njit(cache=True)
def seen_through(h, shown, n, out):  # type: ignore[no-untyped-def]
    """Write the row ``h`` over [z, controllers, ...] as one over z."""
    for i in range(n):
        out[i] = h[i]
    for c in range(len(shown)):
        if h[n + c] != 0.0:
            for i in range(n):
                out[i] += h[n + c] * shown[c, i]


@njit(cache=True)
def closed(F, shown, told, n, slope, has_law, out):  # type: ignore[no-untyped-def]
    """Write what z becomes of z with controllers and valve in the loop, (n, n)."""
    C = len(shown)
    for i in range(n):
        for j in range(n):
            value = F[i, j] + (F[i, n + C] * slope * told[j] if has_law else 0.0)
            for c in range(C):
                by = F[i, n + c] + (F[i, n + C] * slope * told[n + c] if has_law else 0.0)
                if by != 0.0:
                    value += by * shown[c, j]
            out[i, j] = value


@njit(cache=True)
def add_product(A, B, out):  # type: ignore[no-untyped-def]
    """Add A B to ``out``, whole rows at once: sums of different columns do not wait for each other."""
    for i in range(len(A)):
        for k in range(len(B)):
            if A[i, k] != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += A[i, k] * B[k, j]


@njit(cache=True)
def spread(P, A, Q, room):  # type: ignore[no-untyped-def]
    """Replace P by A P A' + Q; ``room`` for what lies between."""
    n = len(P)
    room[:] = 0.0
    add_product(A, P, room)
    for i in range(n):
        for j in range(i):
            room[i, j], room[j, i] = room[j, i], room[i, j]
    P[:] = Q
    add_product(A, room, P)
    for i in range(n):
        for j in range(i):
            P[j, i] = P[i, j]


@njit(cache=True)
def looked(P, h, r, K):  # type: ignore[no-untyped-def]
    """Take in one signal with the row ``h`` of z: write its gain, lower P, return the variance of its innovation."""
    n = len(P)
    s = r
    for i in range(n):
        K[i] = 0.0
    for j in range(n):
        if h[j] != 0.0:
            for i in range(n):
                K[i] += P[j, i] * h[j]
    for i in range(n):
        s += h[i] * K[i]
    s = max(s, SMALLEST)
    for i in range(n):
        for j in range(n):
            P[i, j] -= K[i] * K[j] / s
    for i in range(n):
        K[i] /= s
    return s


@njit(cache=True)
def steady(A, Q, H, r, every, P, K, s):  # type: ignore[no-untyped-def]
    """Write the gains (signals, n) and variances (signals,) to which the filter settles.

    ``P`` (every + 1, n, n) the covariance at each scan behind a row, the last one that before the next row is taken in;
    the first one is start too.
    """
    n, m, all_of_them, P = len(Q), len(H), P, P[0]
    room, B, D = np.empty((n, n)), np.eye(n), np.zeros((n, n))
    for _ in range(every):
        spread(D, A, Q, room)
        B = A @ B
    for turn in range(400):
        spread(P, B, D, room)
        change = 0.0
        for j in range(m):
            new = looked(P, H[j], r[j], K[j])
            change = max(change, abs(new - s[j]) / new)
            s[j] = new
        if change < 1e-10 and turn > 3:
            break
    for k in range(1, len(all_of_them)):
        all_of_them[k] = all_of_them[k - 1]
        spread(all_of_them[k], A, Q, room)


@njit(cache=True)
def filtered(  # type: ignore[no-untyped-def]
    F, v, told, H, Q, limits, memory, of, beyond, last, period, offset, start, U, Y, r, skip, acts, every, law, a, b,
    exact, steady_P, K, s, jumps, e, S, given,
):  # fmt: skip
    """Write the innovations ``e`` (rows, signals) and their variances ``S``; NaN where a signal is not taken in.

    ``U`` (scans, inputs); ``Y`` (rows, signals); ``skip`` signals of a row to leave out; ``acts``: which controller
    gives a signal, -1 for none; ``of``: to which controller each ``memory`` belongs; ``period``, ``offset``: scans of
    each controller; ``exact``: the covariance is carried along, else ``steady_P`` (every + 1, n, n), ``K`` and ``s``
    are what ``steady`` gives; ``jumps`` from row to row where nothing is at a limit (``lifted``);
    ``given`` (scans, controllers) is written too.
    """
    n, N, C, m, columns = len(start), F.shape[1], len(v), len(H), np.ascontiguousarray(F.T)
    z, new, row = start.copy(), np.empty(n), np.zeros(N)
    P, room, A, k_now = np.diag(np.full(n, 1e-4)) * 1.0, np.empty((n, n)), np.empty((n, n)), np.empty(n)
    scans, free, wanted, carried = np.ones(C, dtype=np.bool_), np.ones(C), np.empty(C), True
    sd, at_once, bounds = np.zeros((every, C + 1)), np.zeros((C + 1, n)), np.empty((C + 1, 2))
    slopes(v, n, scans, free, last, at_once[:C])
    bounds[:C] = limits
    bounds[C, 0], bounds[C, 1] = (a, b) if law == STOPS else (-np.inf, np.inf)
    if law == STOPS:
        seen_through(told, at_once[:C], n, at_once[C])
    if not exact:
        for k in range(every):
            for c in range(C + 1):
                sd[k, c] = deviation(at_once[c], steady_P[k])
    out, unsure_by, k = np.empty(n + every * (C + 1)), np.empty((every, C + 1)), -1
    side, push = np.zeros(C, dtype=np.int64), np.zeros(C, dtype=np.int64)
    shown, h, apart = np.empty((C, n)), np.empty(n), np.zeros(len(memory))
    held, loose = z[last[C - 1]], 0.0
    while k + 1 < len(U):
        k += 1
        at = k // every
        may_jump = k % every == 0 and at < len(jumps.at_row)
        steadily = may_jump and not carried
        if steadily and taken_in(z, Y[at], K, s, r, acts, bounds, jumps, jumps.at_row[at], e[at], S[at], new):
            forecast(new, jumps.at_row[at], m, jumps.ahead, out)
            if clear(out, bounds, sd):
                for j in range(every):
                    given[k + j] = out[j * (C + 1) : j * (C + 1) + C]
                z[:] = out[every * (C + 1) :]
                k += every - 1
                continue
        for i in range(n + C + 1, N):
            row[i] = U[k, i - n - C - 1]
        if k % every == 0:
            i = k // every
            for j in range(m):
                if not carried and not np.isfinite(Y[i, j]):  # what is not seen is not known better afterwards
                    carried = True
                    P[:] = steady_P[every]
            for j in range(m):
                e[i, j] = np.nan
                S[i, j] = np.nan
                commanded(row, z, v, limits, period, offset, last, k, scans, free, wanted)
                c = acts[j]
                if c >= 0:
                    lo, hi, guess = limits[c, 0], limits[c, 1], wanted[c]
                    inside = lo < guess < hi
                    at_limit = Y[i, j] >= hi - 1.8 * np.sqrt(12.0 * r[j]) or Y[i, j] <= lo + 1.8 * np.sqrt(12.0 * r[j])
                    beyond_it = Y[i, j] > hi + 4.0 * np.sqrt(r[j]) or Y[i, j] < lo - 4.0 * np.sqrt(r[j])
                    miss = Y[i, j] - min(max(guess, lo), hi)
                    if at_limit and not beyond_it and (not inside or abs(miss) < 12.0 * np.sqrt(s[j])):
                        S[i, j] = CERTAIN * r[j]  # it is where it is said to be: a density of 1 over the rounding
                        continue
                else:
                    row[n + C] = through(law, a, b, along(told, row), held)[2] if law else 0.0
                    miss = Y[i, j] - along(H[j], row)
                if skip[i, j] or not np.isfinite(miss):
                    continue
                if carried:
                    slopes(v, n, scans, free, last, shown)
                    if c < 0:
                        seen_through(H[j], shown, n, h)
                    elif scans[c]:
                        seen_through(v[c], shown[:c], n, h)
                    else:
                        h[:] = shown[c]
                    variance = looked(P, h, r[j], k_now)
                    z += k_now * miss
                else:
                    variance = s[j]
                    for q in range(n):
                        z[q] += K[j, q] * miss
                e[i, j] = miss / np.sqrt(variance)
                S[i, j] = variance
        if carried and not exact and k % every == 0:
            carried = False
            for i in range(n):
                if abs(P[i, i] - steady_P[0, i, i]) > SETTLED * steady_P[0, i, i]:
                    carried = True
                    break
        if may_jump and carried:
            forecast(z, jumps.at_row[at], m, jumps.ahead, out)
            for j in range(every):
                for c in range(C + 1):
                    h[:] = jumps.ahead[:, j * (C + 1) + c]
                    unsure_by[j, c] = math.sqrt(deviation(h, P) ** 2 + jumps.loose[j, c])
            if clear(out, bounds, unsure_by):
                for j in range(every):
                    given[k + j] = out[j * (C + 1) : j * (C + 1) + C]
                z[:] = out[every * (C + 1) :]
                spread(P, jumps.whole, jumps.grown, room)
                k += every - 1
                continue
        commanded(row, z, v, limits, period, offset, last, k, scans, free, wanted)
        for c in range(C):
            if not (scans[c] and np.isfinite(limits[c, 0]) and np.isfinite(limits[c, 1])):
                continue
            far = min(wanted[c] - limits[c, 0], limits[c, 1] - wanted[c])
            if not carried and far < CLOSE * sd[k % every, c]:
                carried = True
                P[:] = steady_P[k % every]
            if carried:
                slopes(v, n, scans, free, last, shown)
                seen_through(v[c], shown[:c], n, h)
                spread_here = deviation(h, P)
                if spread_here > 0.0 and abs(far) < CLOSE * spread_here:
                    row[n + c], free[c] = within(wanted[c], spread_here, limits[c, 0], limits[c, 1])
                    for d in range(c + 1, C):
                        row[n + d] = 0.0
                    for d in range(c + 1, C):
                        if scans[d]:
                            wanted[d] = along(v[d], row)
                            row[n + d] = min(max(wanted[d], limits[d, 0]), limits[d, 1])
                            free[d] = 1.0 if row[n + d] == wanted[d] else 0.0
                        else:
                            row[n + d] = wanted[d]
        for c in range(C):
            given[k, c] = row[n + c]
        if law == STOPS and not carried:
            opening = along(told, row)
            if min(opening - a, b - opening) < CLOSE * sd[k % every, C]:
                carried = True
                P[:] = steady_P[k % every]
        slope, more = 1.0, 0.0
        if carried:
            slopes(v, n, scans, free, last, shown)
        if law:
            unsure = 0.0
            if carried:
                seen_through(told, shown, n, h)
                unsure = deviation(h, P)
            row[n + C], slope, more, held, loose = blurred(law, a, b, along(told, row), unsure, held, loose)
        for i in range(n):
            new[i] = 0.0
        for j in range(N):
            if row[j] != 0.0:
                for i in range(n):
                    new[i] += columns[j, i] * row[j]
        for q in range(len(memory)):
            c, i = of[q], memory[q]
            if q == 0 or of[q - 1] != c:
                side[c] = 0 if limits[c, 1] - wanted[c] < wanted[c] - limits[c, 0] else 1
                push[c] = 0 if (new[i] > z[i]) == (side[c] == 0) else 1
            apart[q] = 0.0
            if not scans[c]:
                new[i] = z[i]
            elif free[c] < 1.0:
                apart[q] = along(beyond[side[c], push[c], q], row) - new[i]
                new[i] += (1.0 - free[c]) * apart[q]
        if carried:
            closed(F, shown, told, n, slope, law > 0, A)
            for q in range(len(memory)):
                c, i = of[q], memory[q]
                if not scans[c]:
                    A[i] = 0.0
                    A[i, i] = 1.0
                elif free[c] < 1.0:
                    seen_through(beyond[side[c], push[c], q], shown, n, h)
                    A[i] = free[c] * A[i] + (1.0 - free[c]) * h
            spread(P, A, Q, room)
            for q in range(len(memory)):
                c, i = of[q], memory[q]
                P[i, i] += free[c] * (1.0 - free[c]) * apart[q] ** 2
            if more > 0.0:
                for i in range(n):
                    for j in range(n):
                        P[i, j] += more * F[i, n + C] * F[j, n + C]
        for i in range(n):
            z[i] = new[i]
