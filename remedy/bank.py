"""A bank of stems that sees PV: where a sticky stem stood, and how likely the record is with it.

    stem i     sticks at x_i until |OP - x_i| > b_i;  then stands at OP -+ d_i
               b_i = f_s + r f_s N(0, 1),  d_i = f_d + r f_s N(0, 1), new at each slip;   f_s, f_d = (S +- J)/2
    behind it  y_i = K G x_i,  v_i = PV - y_i - c - d t,   e_i = v_i(t) - sum a_k v_i(t-k)
    weights    w_i <- w_i p(e_i), p Student's t of spread s;    log-likelihood of a row = ln sum w_i p(e_i)

No stem slips to the last digit as its model does, and one that slips by J keeps its place: a path without sight of PV
is lost after a few slips.  A breakaway that varied from scan to scan would be passed at its least value, so that S
would come out too large; it varies from slip to slip.  Stems are drawn again where weights are uneven; where the best
of them misses a row by far, half are put anywhere within the band in which a stem can stick.

Stems stand beside each other in the last place of every array, so that the processor takes several at once.
What is shown is one likely path, with its past: the stem of most weight at the end, back through the draws.  The mean
of stems that differ is no stem, and a gain by least squares behind it comes out too small.
Source: particle filter with the process behind it given the path (Doucet, de Freitas and Gordon 2001); the bank of
``stickslip.gap.filters.stems`` is the same with the gains of a model's filter.
"""

import math
from typing import Any

import numpy as np
from stickslip.logs.compiled import njit

STEMS = 32
EVEN = 0.5  # share of the stems that must count
LOST = 5.0  # spreads by which even the best stem misses
NU = 5.0  # degrees of freedom: p(e) goes by (1 + e^2 / NU s^2)^-3
NORMAL = math.lgamma(0.5 * (NU + 1.0)) - math.lgamma(0.5 * NU) - 0.5 * math.log(NU * math.pi)


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def passed(  # type: ignore[no-untyped-def]
    u, y, q, dt, follows, S, J, r, integrating, tau, tau_2, theta, K, a, c, d, s, noise, shown
) -> Any:
    """Return the log-likelihood of rows y (n,) of ``q`` samples of OP u; write a likely path to ``shown``.

    ``follows``: a stem that moves goes on with OP; ``noise`` (2, samples, stems) normal deviates.
    ``shown`` (2, samples): the stem that is likeliest at the end, with its past, and its answer with K = 1.
    """
    M, p, n = noise.shape[2], len(a), len(y)
    f_s, f_d = 0.5 * (S + J), 0.5 * (S - J)
    whole = int(theta / dt)
    share, slots = theta / dt - whole, whole + 2
    ring, past = np.empty((slots, M)), np.zeros((p, M))
    x, one, two, held, begun = np.empty(M), np.empty(M), np.empty(M), np.empty(M), np.empty(M)
    way, moves, limit, drags = np.zeros(M), np.zeros(M), np.empty(M), np.full(M, f_d)
    w, e, total, kept = np.full(M, 1.0 / M), np.empty(M), np.zeros(M), np.empty(M)
    pick, spare = np.empty(M, dtype=np.int64), np.empty(M)
    for i in range(M):
        x[i] = u[0] + f_s * (2.0 * (i + 0.5) / M - 1.0) if S > 0.0 else u[0]
        limit[i] = max(f_s * (1.0 + r * noise[0, 0, i]), 0.2 * f_s, f_d)
        ring[:, i] = begun[i] = x[i]
        one[i] = two[i] = 0.0 if integrating else x[i]
    keeps, takes, keeps_2, blends = _steps(integrating, tau, tau_2, dt)
    found, moving = 0.0, 0
    stems, parents = np.empty((n * q, M)), np.empty((n, M), dtype=np.int16)
    for k in range(n * q):
        at, before, now = ring[(k - 1 - whole) % slots], ring[(k - 2 - whole) % slots], ring[k % slots]
        if k > 0:  # the process first: what was held until now shows now
            for i in range(M):
                held[i] = keeps * one[i] + takes * ((1.0 - share) * at[i] + share * before[i])
                two[i] = keeps_2 * two[i] + (1.0 - keeps_2) * (blends * one[i] + (1.0 - blends) * held[i])
                one[i] = held[i]
        pulled = 0
        for i in range(M):
            total[i] += two[i]
            pulled += abs(u[k] - x[i]) > limit[i]
        if S <= 0.0:
            x[:] = u[k]
        elif moving + pulled > 0:
            moving = 0
            for i in range(M):
                pull = u[k] - x[i]
                if moves[i] > 0.0:
                    if way[i] * pull > drags[i]:
                        x[i] = u[k] - way[i] * drags[i]
                    else:
                        moves[i] = 0.0
                if moves[i] == 0.0 and abs(pull) > limit[i]:
                    way[i] = 1.0 if pull > 0.0 else -1.0
                    drags[i] = f_d + r * f_s * noise[1, k, i]
                    x[i] = u[k] - way[i] * drags[i]
                    limit[i] = max(f_s * (1.0 + r * noise[0, k, i]), 0.2 * f_s, drags[i])
                    moves[i] = follows
                moving += moves[i] > 0.0
        stems[k] = x
        now[:] = x
        if (k + 1) % q != 0:
            continue
        row = k // q
        best = math.inf
        for i in range(M):
            parents[row, i] = i
            kept[i] = e[i] = y[row] - K * total[i] / q - c - d * row
            total[i] = 0.0
        for j in range(p):
            old = past[(row - 1 - j) % p]
            for i in range(M):
                e[i] -= a[j] * old[i]
        past[row % p] = kept
        if row < 2 * p:
            continue
        mixed = 0.0
        for i in range(M):
            best = min(best, abs(e[i]))
            likely = 1.0 / (1.0 + (e[i] / s) ** 2 / NU)
            kept[i] = w[i] * likely * likely * likely + 1e-300
            mixed += kept[i]
        found += math.log(mixed) + NORMAL - math.log(s)
        if S <= 0.0:
            continue
        uneven = 0.0
        for i in range(M):
            w[i] = kept[i] / mixed
            uneven += w[i] ** 2
        lost = best > LOST * s
        if uneven * M * EVEN < 1.0 and not lost:
            continue
        j, reached = 0, w[0]
        for i in range(M):
            level = (i + 0.5) / M
            while reached < level and j < M - 1:
                j += 1
                reached += w[j]
            pick[i] = j
            parents[row, i] = j
        w[:] = 1.0 / M
        for own in (x, one, two, way, moves, limit, drags):
            _drawn(own, pick, spare)
        for j in range(slots):
            _drawn(ring[j], pick, spare)
        for j in range(p):
            _drawn(past[j], pick, spare)
        moving = 0
        for i in range(M):
            if i % 4 == 0:  # a little apart, or they would all be one
                x[i] += 0.1 * r * f_s * noise[1, k, i]
            b = f_s * (1.0 + r * noise[0, k, i])
            if b > abs(u[k] - x[i]):  # a breakaway that this stem may still have
                limit[i] = max(b, drags[i])
            if lost and i % 2 == 0:
                x[i] = u[k] + f_s * (2.0 * (i + 0.5) / M - 1.0)
                moves[i] = 0.0
            moving += moves[i] > 0.0
    i = int(np.argmax(w))
    for k in range(n * q - 1, -1, -1):
        if (k + 1) % q == 0:
            i = parents[k // q, i]
        shown[0, k] = stems[k, i]
    _answer(begun[i], whole, share, keeps, takes, keeps_2, blends, 0.0 if integrating else begun[i], shown)
    return found


@njit(cache=True)  # type: ignore[untyped-decorator]
def _steps(integrating: bool, tau: float, tau_2: float, dt: float) -> Any:
    """What the first lag keeps and takes in, what the second keeps, and how much of the old first one it sees."""
    a = math.exp(-dt / tau)
    keeps, takes = (1.0, dt) if integrating else (a, 1.0 - a)
    return (keeps, takes, math.exp(-dt / tau_2), 0.5) if tau_2 > 0.0 else (keeps, takes, 0.0, 0.0)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _drawn(values: Any, pick: Any, spare: Any) -> None:
    """Give each stem the value of the one that it now continues."""
    spare[:] = values
    for i in range(len(pick)):
        values[i] = spare[pick[i]]


@njit(cache=True)  # type: ignore[untyped-decorator]
def _answer(  # type: ignore[no-untyped-def]
    begun, whole, share, keeps, takes, keeps_2, blends, one, shown
) -> None:
    """Write the answer ``shown[1]`` of the process to the stem ``shown[0]``, which stood at ``begun`` before."""
    two, x = one, shown[0]
    for k in range(len(x)):
        if k > 0:
            at = x[k - 1 - whole] if k > whole else begun
            before = x[k - 2 - whole] if k > whole + 1 else begun
            new = keeps * one + takes * ((1.0 - share) * at + share * before)
            two = keeps_2 * two + (1.0 - keeps_2) * (blends * one + (1.0 - blends) * new)
            one = new
        shown[1, k] = two
