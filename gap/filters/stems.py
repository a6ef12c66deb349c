"""A bank of stems: the likelihood of a log whose valve sticks, where no log shows the stem.

Each stem of the bank has its own path and, given that path, its own Kalman mean; all share one gain, for which the
opening is known.  At a row

    w_i <- w_i N(e_i; 0, 1),      likelihood of the row = sum w_i N(e_i; 0, 1)

and stems are drawn again where the weights are uneven.  Between rows nobody knows what the valve was told: each stem
sees its own mean of OP with the random part that each scan's noise gives it; at a row all see the logged OP.  With
the same random numbers for all sizes the likelihood is smooth in them.

    a stem sticks at x until |OP - x| > (S + J)/2, and then stands at OP -+ (S - J)/2          (``quasi_static_stem``)

Each stem of the bank breaks away a little early or late, as no friction repeats to the last digit: so one slip is not
had wrong by all.  Where even the best stem misses a row by far, half of them are put anywhere within the band in which
a stem can stick, which costs as much as a mode that a replay sets right (``gap.floors.modes``).

A mixture's innovation is the normal deviate of its distribution function, sum w_i Phi(e_i): of unit variance if it is
right, like those of a single filter.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from gap.filters.kalman import along, commanded, looked, spread
from gap.floors.modes import CHARGE

EVEN = 0.5  # share of the stems that must count
LOST = 5.0  # standard deviations by which even the best stem misses a row where none has the right mode


@njit(cache=True)
def normal(x):  # type: ignore[no-untyped-def]
    """Return the distribution function of a normal deviate."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True)
def stuck(x, told, S, J, repeats):  # type: ignore[no-untyped-def]
    """Return where a stem stands after it was told an opening; ``repeats`` its breakaway as a multiple of the mean."""
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
def banked(  # type: ignore[no-untyped-def]
    F, v, told, H, limits, memory, of, beyond, last, start, U, Y, acts, moves, every, K, s, jitter, S, J, draws, turns,
    repeats, e, loss, path,
):  # fmt: skip
    """Write innovations ``e`` (rows, signals) and the loss of each row [nats].

    ``draws`` (scans, stems), ``turns`` (rows,), ``repeats`` (stems,) random numbers; ``acts``: which controller gives a
    signal, -1 for none; ``moves``: which moves the stem, ``jitter`` of its output between rows.
    """
    n, N, C, M, m = len(start), F.shape[1], len(v), draws.shape[1], len(H)
    period, offset, scans = np.ones(C, dtype=np.int64), np.zeros(C, dtype=np.int64), np.ones(C, dtype=np.bool_)
    free, wanted, at_mv = np.ones(C), np.empty(C), n + C
    lo, hi = limits[moves, 0], limits[moves, 1]
    z = np.empty((M, n))
    x = np.empty(M)
    row, new, w = np.zeros(N), np.empty(n), np.full(M, 1.0 / M)
    miss, other_z, other_x = np.empty(M), np.empty((M, n)), np.empty(M)
    for i in range(M):
        z[i] = start
        row[:n] = start
        row[n:at_mv] = start[last]
        row[at_mv + 1 :] = U[0]
        x[i] = along(told, row) + 0.45 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
    lost, seen = False, np.nan
    for k in range(len(U)):
        row[at_mv + 1 :] = U[k]
        phase = k % every
        if phase == 0:
            at = k // every
            loss[at] = 0.0
            lost, seen = False, np.nan
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
                below, total, largest = 0.0, 0.0, -np.inf
                for i in range(M):
                    commanded(row, z[i], v, limits, period, offset, last, k, scans, free, wanted)
                    row[at_mv] = x[i]
                    guess = wanted[c] if c >= 0 else along(H[j], row)
                    miss[i] = (Y[at, j] - guess) / math.sqrt(s[j])
                    below += w[i] * normal(miss[i])
                    largest = max(largest, -0.5 * miss[i] ** 2)
                for i in range(M):
                    for q in range(n):
                        z[i, q] += K[j, q] * miss[i] * math.sqrt(s[j])
                    w[i] *= math.exp(-0.5 * miss[i] ** 2 - largest)
                    total += w[i]
                if not total > 0.0:  # every stem that counted is excluded: none counts more than another
                    total = 0.0
                    for i in range(M):
                        w[i] = math.exp(-0.5 * miss[i] ** 2 - largest) / M
                        total += w[i]
                for i in range(M):
                    w[i] /= total
                loss[at] += 0.5 * math.log(s[j]) - largest - math.log(total)
                lost = lost or largest < -0.5 * LOST**2
                e[at, j] = below
            path[at] = 0.0
            for i in range(M):
                path[at] += w[i] * x[i]
            even = 0.0
            for i in range(M):
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
                    other_z[q] = z[i]
                    other_x[q] = x[i]
                z[:] = other_z
                x[:] = other_x
                w[:] = 1.0 / M
        for i in range(M):
            for q in range(n):
                row[q] = z[i, q]
            for c in range(C):  # as in ``commanded``, without a call for each stem: that takes longer than the rest
                total = 0.0
                for q in range(n + c):
                    total += v[c, q] * row[q]
                for q in range(at_mv + 1, N):
                    total += v[c, q] * row[q]
                wanted[c] = total
                row[n + c] = min(max(total, limits[c, 0]), limits[c, 1])
                free[c] = 1.0 if row[n + c] == total else 0.0
            op = row[n + moves]
            known = phase == 0 and np.isfinite(seen)
            row[n + moves] = seen if known else min(max(op + jitter * draws[k, i], lo), hi)
            opening = along(told, row)
            if phase == 0 and lost and i % 2 == 1:
                x[i] = opening + 0.5 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
            x[i] = stuck(x[i], opening, S, J, repeats[i])
            row[n + moves] = op
            row[at_mv] = x[i]
            for q in range(n):
                total = 0.0
                for p in range(N):
                    total += F[q, p] * row[p]
                new[q] = total
            for q in range(len(memory)):
                c, at_z = of[q], memory[q]
                if q == 0 or of[q - 1] != c:
                    side = 0 if wanted[c] > row[n + c] else 1
                    push = 0 if (new[at_z] > z[i, at_z]) == (side == 0) else 1
                if free[c] < 1.0:
                    new[at_z] = along(beyond[side, push, q], row)
            for q in range(n):
                z[i, q] = new[q]


def deviates(below: Any) -> Any:
    """Return the normal deviates of shares below them."""
    from scipy.special import ndtri

    return ndtri(np.clip(below, 1e-15, 1.0 - 1e-15))
