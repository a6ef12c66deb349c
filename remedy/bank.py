"""A bank of stems that sees PV: where a sticky stem stood, and how likely the record is with it.

    stem i     sticks at x_i until |OP - x_i| > b_i;  then stands at OP -+ d_i
               b_i = f_s + r f_s N(0, 1),  d_i = f_d + r f_s N(0, 1), new at each slip;   f_s, f_d = (S +- J)/2
    behind it  y_i = K G x_i,  v_i = PV - y_i - c - d t,   e_i = v_i(t) - sum a_k v_i(t-k)
    weights    w_i <- w_i p(e_i), p Student's t of spread s;    log-likelihood of a row = ln sum w_i p(e_i)

No stem slips to the last digit as its model does, and one that slips by J keeps its place: a path without sight of PV
is lost after a few slips.  A breakaway that varied from scan to scan would be passed at its least value, so that S
would come out too large; it varies from slip to slip.  Stems are drawn again where weights are uneven; where the best
of them misses a row by far, half are put anywhere within the band in which a stem can stick.

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
NU = 5.0
NORMAL = math.lgamma(0.5 * (NU + 1.0)) - math.lgamma(0.5 * NU) - 0.5 * math.log(NU * math.pi)


@njit(cache=True)  # type: ignore[untyped-decorator]
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
    share = theta / dt - whole
    ring = np.empty((whole + 2, M))
    x, one, two = np.empty(M), np.empty(M), np.empty(M)
    way, moves = np.zeros(M), np.zeros(M)
    holds, drags = np.full(M, f_s), np.full(M, f_d)
    past, w = np.zeros((M, p)), np.full(M, 1.0 / M)
    e, total, kept, pick = np.empty(M), np.zeros(M), np.empty(M), np.empty(M, dtype=np.int64)
    for i in range(M):
        x[i] = u[0] + f_s * (2.0 * (i + 0.5) / M - 1.0) if S > 0.0 else u[0]
        ring[:, i] = x[i]
        holds[i] = max(f_s * (1.0 + r * noise[0, 0, i]), 0.2 * f_s)
        one[i] = 0.0 if integrating else x[i]
        two[i] = one[i]
    a1 = 1.0 if integrating else math.exp(-dt / tau)
    a2 = math.exp(-dt / tau_2) if tau_2 > 0.0 else 0.0
    found, seen = 0.0, 0
    stems, answers = np.empty((n * q, M)), np.empty((n * q, M))
    parents = np.empty((n, M), dtype=np.int16)
    for k in range(n * q):
        at, before, now = (k - 1 - whole) % (whole + 2), (k - 2 - whole) % (whole + 2), k % (whole + 2)
        for i in range(M):
            # the process first: what was held until now shows now
            if k > 0:
                held = (1.0 - share) * ring[at, i] + share * ring[before, i]
                last = one[i]
                one[i] = last + dt * held if integrating else a1 * last + (1.0 - a1) * held
                two[i] = a2 * two[i] + (1.0 - a2) * (0.5 * (last + one[i]) if a2 > 0.0 else one[i])
            total[i] += two[i]
            answers[k, i] = two[i]
            if S > 0.0:
                pull = u[k] - x[i]
                if moves[i] > 0.0:
                    if way[i] * pull > drags[i]:
                        x[i] = u[k] - way[i] * drags[i]
                    else:
                        moves[i] = 0.0
                if moves[i] == 0.0 and abs(pull) > max(holds[i], drags[i]):
                    way[i] = 1.0 if pull > 0.0 else -1.0
                    drags[i] = f_d + r * f_s * noise[1, k, i]
                    x[i] = u[k] - way[i] * drags[i]
                    holds[i] = max(f_s * (1.0 + r * noise[0, k, i]), 0.2 * f_s)
                    moves[i] = follows
            else:
                x[i] = u[k]
            stems[k, i] = x[i]
            ring[now, i] = x[i]
        if (k + 1) % q != 0:
            continue
        row = k // q
        for i in range(M):
            parents[row, i] = i
        best = math.inf
        for i in range(M):
            v = y[row] - K * total[i] / q - c - d * row
            total[i] = 0.0
            e[i] = v
            for j in range(p):
                e[i] -= a[j] * past[i, j]
            for j in range(p - 1, 0, -1):
                past[i, j] = past[i, j - 1]
            past[i, 0] = v
            best = min(best, abs(e[i]))
        if row < 2 * p:
            continue
        mixed = 0.0
        for i in range(M):
            kept[i] = w[i] * (1.0 + (e[i] / s) ** 2 / NU) ** (-0.5 * (NU + 1.0)) + 1e-300
            mixed += kept[i]
        found += math.log(mixed) + NORMAL - math.log(s)
        seen += 1
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
        X, A, B, R, P, Z, V = x.copy(), one.copy(), two.copy(), ring.copy(), past.copy(), way.copy(), moves.copy()
        H, D = holds.copy(), drags.copy()
        for i in range(M):
            j = pick[i]
            parents[row, i] = j
            x[i], one[i], two[i], way[i], moves[i], holds[i], drags[i] = X[j], A[j], B[j], Z[j], V[j], H[j], D[j]
            ring[:, i] = R[:, j]
            past[i] = P[j]
            w[i] = 1.0 / M
            if i % 4 == 0:  # a little apart, or they would all be one
                x[i] += 0.1 * r * f_s * noise[1, k, i]
            b = f_s * (1.0 + r * noise[0, k, i])
            if b > abs(u[k] - x[i]):  # a breakaway that this stem may still have
                holds[i] = b
            if lost and i % 2 == 0:
                x[i] = u[k] + f_s * (2.0 * (i + 0.5) / M - 1.0)
                moves[i] = 0.0
    i = int(np.argmax(w))
    for k in range(n * q - 1, -1, -1):
        if (k + 1) % q == 0:
            i = parents[k // q, i]
        shown[0, k] = stems[k, i]
        shown[1, k] = answers[k, i]
    return found, seen
