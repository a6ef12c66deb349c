"""A bank of stems: the likelihood of a log whose valve sticks, where no log shows the stem.

Each stem of the bank has its own path and, given that path, its own Kalman mean; its gain goes by the share of the
last scans at which it moved: while it stands the opening is known, while it follows OP the loop is closed.  At a row

    w_i <- w_i N(miss_i; 0, s_i),      likelihood of the row = sum w_i N(miss_i; 0, s_i)

and stems are drawn again where the weights are uneven.  Between rows nobody knows what the valve was told: each stem
sees its own mean of OP with the random part that each scan's noise gives it; at a row all see the logged OP.  With
the same random numbers for all sizes the likelihood is smooth in them.

    a stem sticks at x until |OP - x| > (S + J)/2, and then stands at OP -+ (S - J)/2          (``quasi_static_stem``)

Each stem of the bank breaks away a little early or late, as no friction repeats to the last digit: so one slip is not
had wrong by all.  Where even the best stem misses a row by far, half of them are put anywhere within the band in which
a stem can stick, which costs as much as a mode that a replay sets right (``stickslip.gap.floors.modes``).

A mixture's innovation is the normal deviate of its distribution function, sum w_i Phi(e_i): of unit variance if it is
right, like those of a single filter.
"""

import math
from typing import Any

import numpy as np
from stickslip.gap.filters.kalman import looked, spread
from stickslip.gap.filters.passing import along
from stickslip.gap.floors.modes import CHARGE
from stickslip.logs.compiled import njit

EVEN = 0.5  # share of the stems that must count
LOST = 5.0  # standard deviations by which even the best stem misses a row where none has the right mode


@njit(cache=True)
def normal(x):  # type: ignore[no-untyped-def]
    """Return the distribution function of a normal deviate."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True)
def stuck(x, told, S, J, repeats):  # type: ignore[no-untyped-def]
    """Return where a stem stands after its input has become an opening; ``repeats`` is its breakaway over the mean
    one.
    """
    pull = told - x
    if abs(pull) > max(0.5 * (S + J) * repeats, 0.5 * (S - J)):
        return told - math.copysign(0.5 * (S - J), pull)
    return x


def unsure(Q: Any, v: Any) -> float:
    """Return the standard deviation of what the noise of one scan alone makes of OP.

    The rest of what is not known between two rows lasts, and the rows on both sides tell it.
    """
    return math.sqrt(max(float(v @ Q @ v), 0.0))


@njit(cache=True)
def settled_gains(A, Q, H, r, every, K, s):  # type: ignore[no-untyped-def]
    """Write the gains and variances of all signals behind a row."""
    n, m = len(Q), len(H)
    P, W = np.eye(n) * 1e-4, np.empty((n, n))
    for _ in range(80):
        for _ in range(every):
            spread(P, A, Q, W)
        for j in range(m):
            s[j] = looked(P, H[j], r[j], K[j])


@njit(cache=True)
def summed(row, R, u, out):  # type: ignore[no-untyped-def]
    """Write ``row`` times what each stem has, ``R`` (states, stems), and times what all share, ``u``."""
    for i in range(len(out)):
        out[i] = 0.0
    for p in range(len(R)):
        if row[p] != 0.0:
            by = row[p]
            for i in range(len(out)):
                out[i] += by * R[p, i]
    for p in range(len(u)):
        if row[len(R) + p] != 0.0:
            by = row[len(R) + p] * u[p]
            for i in range(len(out)):
                out[i] += by


@njit(cache=True)
def told_by(v, limits, u, R, n, wanted):  # type: ignore[no-untyped-def]
    """Write what each controller gives each stem into ``R``, and what it would give without limits, ``wanted``."""
    for c in range(len(v)):
        for d in range(c, len(v)):
            R[n + d] = 0.0
        summed(v[c], R, u, wanted[c])
        for i in range(R.shape[1]):
            R[n + c, i] = min(max(wanted[c, i], limits[c, 0]), limits[c, 1])


@njit(cache=True)
def banked(  # type: ignore[no-untyped-def]
    F, v, told, H, limits, memory, of, beyond, last, start, U, Y, acts, moves, every, K, s, lately, jitter, S, J, draws,
    turns, repeats, e, loss, path,
):  # fmt: skip
    """Write shares below each innovation, ``e`` (rows, signals), and the negative log likelihood of each row.

    ``K`` (shares, signals, n) and ``s`` (shares, signals) for stems that move at none to all of the scans, ``lately``
    the weight of one scan in that share.
    ``draws`` (scans, stems), ``turns`` (rows,), ``repeats`` (stems,) random numbers; ``acts``: which controller gives a
    signal, -1 for none; ``moves``: which moves the stem, ``jitter`` of its output between rows.
    """
    n, N, C, M, m = len(start), F.shape[1], len(v), draws.shape[1], len(H)
    lo, hi, at_mv = limits[moves, 0], limits[moves, 1], n + C
    # rows over [z, OPs, MV], a column for each stem: what all stems share of a sum is added to all of them at once
    R, new, wanted, guess = np.empty((at_mv + 1, M)), np.empty((n, M)), np.empty((C, M)), np.empty(M)
    z, x, w = R[:n], R[at_mv], np.full(M, 1.0 / M)
    miss, other, opening, row = np.empty(M), np.empty((at_mv + 1, M)), np.empty(M), np.zeros(N)
    moving, moves_of, kind, count = np.zeros(M), np.empty(M), np.zeros(M, dtype=np.int64), len(s)
    for q in range(n):
        z[q] = start[q]
    for c in range(C):
        R[n + c] = start[last[c]]
    R[at_mv] = 0.0
    summed(told, R, U[0], opening)
    for i in range(M):
        x[i] = opening[i] + 0.45 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
    lost, seen = False, np.nan
    for k in range(len(U)):
        phase = k % every
        if phase == 0:
            at = k // every
            loss[at] = 0.0
            lost, seen = False, np.nan
            for i in range(M):
                kind[i] = min(int(moving[i] * (count - 1) + 0.5), count - 1)
            for j in range(m):
                e[at, j] = np.nan
                if not np.isfinite(Y[at, j]):
                    continue
                c = acts[j]
                if c == moves:
                    seen = Y[at, j]
                if c >= 0:
                    near = 0.002 * (limits[c, 1] - limits[c, 0])
                    if Y[at, j] >= limits[c, 1] - near or Y[at, j] <= limits[c, 0] + near:
                        continue
                told_by(v, limits, U[k], R, n, wanted)
                if c >= 0:
                    guess[:] = wanted[c]
                else:
                    summed(H[j], R, U[k], guess)
                below, total, largest = 0.0, 0.0, -np.inf
                for i in range(M):
                    size = s[kind[i], j]
                    gap = Y[at, j] - guess[i]
                    miss[i] = -0.5 * gap * gap / size - 0.5 * math.log(size / s[0, j])
                    below += w[i] * normal(gap / math.sqrt(size))
                    largest = max(largest, miss[i])
                    guess[i] = gap
                for q in range(n):
                    for i in range(M):
                        z[q, i] += K[kind[i], j, q] * guess[i]
                for i in range(M):
                    w[i] *= math.exp(miss[i] - largest)
                    total += w[i]
                if not total > 0.0:  # every stem that counted is excluded: none counts more than another
                    total = 0.0
                    for i in range(M):
                        w[i] = math.exp(miss[i] - largest) / M
                        total += w[i]
                for i in range(M):
                    w[i] /= total
                loss[at] += 0.5 * math.log(s[0, j]) - largest - math.log(total)
                lost = lost or largest < -0.5 * LOST**2
                e[at, j] = below
            path[at] = 0.0
            even = 0.0
            for i in range(M):
                path[at] += w[i] * x[i]
                even += w[i] ** 2
            if lost:
                loss[at] += CHARGE
            if lost or 1.0 / even < EVEN * M:
                passed, i = w[0], 0
                for q in range(M):
                    share = (q + turns[at]) / M
                    while passed < share and i < M - 1:
                        i += 1
                        passed += w[i]
                    for p in range(at_mv + 1):
                        other[p, q] = R[p, i]
                    moves_of[q] = moving[i]
                R[:] = other
                moving[:] = moves_of
                w[:] = 1.0 / M
        told_by(v, limits, U[k], R, n, wanted)
        op = R[n + moves]
        known = phase == 0 and np.isfinite(seen)
        for i in range(M):
            guess[i] = op[i]
            op[i] = seen if known else min(max(guess[i] + jitter * draws[k, i], lo), hi)
        summed(told, R, U[k], opening)
        if phase == 0 and lost:
            for i in range(1, M, 2):
                x[i] = opening[i] + 0.5 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
        for i in range(M):
            stood = x[i]
            x[i] = stuck(stood, opening[i], S, J, repeats[i])
            moving[i] += ((1.0 if x[i] != stood else 0.0) - moving[i]) * lately
            op[i] = guess[i]
        for q in range(n):
            summed(F[q], R, U[k], new[q])
        for c in range(C):
            for i in range(M):
                if R[n + c, i] != wanted[c, i]:
                    row[: at_mv + 1] = R[:, i]
                    row[at_mv + 1 :] = U[k]
                    side, push = 0 if wanted[c, i] > R[n + c, i] else 1, -1
                    for q in range(len(memory)):
                        if of[q] == c:
                            if push < 0:
                                push = 0 if (new[memory[q], i] > z[memory[q], i]) == (side == 0) else 1
                            new[memory[q], i] = along(beyond[side, push, q], row)
        z[:] = new


def deviates(below: Any) -> Any:
    """Return the normal deviates of shares below them."""
    from scipy.special import ndtri

    return ndtri(np.clip(below, 1e-15, 1.0 - 1e-15))
