"""A bank of stems that sees PV: where a sticky stem stood, and how likely the record is with it.

    stem i     sticks at x_i until |OP - x_i| > b_i;  then stands at OP -+ f_d + o_i;   f_s, f_d = (S +- J)/2
               b_i = f_s + r f_s N(0, 1),  o_i = r f_s N(0, 1), new at each slip
    behind it  y_i = K G x_i,  v_i = PV - y_i - c - d t,   e_i = v_i(t) - sum a_k v_i(t-k)
    off        o_i ~ N(m_i, P_i): a row tells e_i - K g o_i, g what a step since the slip gives
    weights    w_i <- w_i p(e_i - K g m_i), p Student's t of spread sqrt(s^2 + K^2 g^2 P_i)
               log-likelihood of a row = ln sum w_i p

No stem slips to the last digit as its model does, and one that slips by J keeps its place: a path without sight of PV
is lost after a few slips.  A breakaway that varied from scan to scan would be passed at its least value, so that S
would come out too large; it varies from slip to slip.  How far a stem is off its place of rest is not drawn: a Kalman
filter of one number follows it, and it is drawn from what that says once the stem slips again.  Stems are drawn again
where weights are uneven; where the best of them misses a row by far, half are put anywhere within the band in which a
stem can stick.

What is shown is one likely path, with its past: the stem of most weight at the end, back through the draws.  The mean
of stems that differ is no stem, and a gain by least squares behind it comes out too small.
Source: Rao-Blackwellised particle filter (Doucet, de Freitas, Murphy and Russell, UAI 2000); that of
``stickslip.engine.bank`` is for any diagram, with the gains of a model's filter.
"""

import math
from typing import Any

import numpy as np
from stickslip.logs.compiled import njit
from stickslip.remedy.left import NU, turns_of

STEMS = 32
EVEN = 0.5  # share of the stems that must count
LOST = 5.0  # spreads by which even the best stem misses
NORMAL = math.lgamma(0.5 * (NU + 1.0)) - math.lgamma(0.5 * NU) - 0.5 * math.log(NU * math.pi)


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def passed(  # type: ignore[no-untyped-def]
    u, y, q, dt, follows, S, J, r, integrating, tau, tau_2, theta, K, a, c, d, s, noise, shown, each
) -> None:
    """Write the log-likelihood of rows y (n,) of ``q`` samples of OP u to ``each``, and a likely path to ``shown``.

    ``follows``: a stem that moves goes on with OP; ``noise`` (2, samples, stems) normal deviates.
    ``shown`` (2, samples): the stem that is likeliest at the end, with its past, and its answer with K = 1.
    """
    M, p, n = noise.shape[2], len(a), len(y)
    f_s, f_d = 0.5 * (S + J), 0.5 * (S - J)
    whole = int(theta / dt)
    share, slots = theta / dt - whole, whole + 2
    lags, turns = turns_of(a)
    ring, past, sums = np.empty((slots, M)), np.zeros((p + 1, M)), np.zeros(M)
    x, one, two, held, begun = np.empty(M), np.empty(M), np.empty(M), np.empty(M), np.empty(M)
    way, moves, limit, stray = np.zeros(M), np.zeros(M), np.empty(M), np.zeros(M)
    off, unsure, born = np.zeros(M), np.full(M, (r * f_s) ** 2), np.zeros(M, dtype=np.int64)
    g = np.empty(M)
    w, e, total, kept, away = np.full(M, 1.0 / M), np.empty(M), np.zeros(M), np.empty(M), np.empty(M)
    heirs, places = np.empty(M, dtype=np.int64), np.empty(M, dtype=np.int64)
    for i in range(M):
        x[i] = u[0] + f_s * (2.0 * (i + 0.5) / M - 1.0) if S > 0.0 else u[0]
        limit[i] = max(f_s * (1.0 + r * noise[0, 0, i]), 0.2 * f_s, f_d)
        ring[:, i] = begun[i] = x[i]
        one[i] = two[i] = 0.0 if integrating else x[i]
    keeps, takes, keeps_2, blends = _steps(integrating, tau, tau_2, dt)
    first, second, summed, rows, seen = _step_tables(
        n * q if S > 0.0 else 1, q, K, lags, turns, whole, share, keeps, takes, keeps_2, blends
    )
    moving, astray = 0, False
    stems, parents, was_off = (
        np.empty((n * q, M)),
        np.empty((n, M), dtype=np.int16),
        np.full((n * q, M), np.nan, dtype=np.float32),
    )
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
            pulled += abs(u[k] - x[i] - off[i]) > limit[i]
        if S <= 0.0:
            x[:] = u[k]
        elif moving + pulled > 0 or astray:
            moving, astray = 0, False
            for i in range(M):
                if moves[i] > 0.0:
                    if way[i] * (u[k] - x[i]) > f_d:
                        x[i] = u[k] - way[i] * f_d
                    else:
                        moves[i] = 0.0
                pull = u[k] - x[i] - off[i]
                slips = moves[i] == 0.0 and abs(pull) > limit[i]
                if slips or stray[i] > 0.0:
                    o, age = off[i] + math.sqrt(unsure[i]) * noise[1, k, i], k - born[i]
                    was_off[k, i] = o
                    one[i] += o * first[age]
                    two[i] += o * second[age]
                    total[i] += o * (summed[age] - (summed[age - k % q - 1] if age > k % q else 0.0))
                    for j in range(min(slots - 1, age)):
                        ring[(k - 1 - j) % slots, i] += o
                    for j in range(min(p + 1, k // q)):
                        then = (k // q - j) * q - 1 - born[i]
                        if then <= 0:
                            break
                        past[(k // q - 1 - j) % (p + 1), i] -= o * rows[then]
                    if (k // q) * q - 1 > born[i]:
                        sums[i] -= o * rows[(k // q) * q - 1 - born[i]]
                    off[i], unsure[i], born[i] = 0.0, (r * f_s) ** 2, k
                    if slips:
                        way[i] = 1.0 if pull > 0.0 else -1.0
                        x[i] = u[k] - way[i] * f_d
                        moves[i] = follows
                    else:
                        x[i] = u[k] + f_s * (2.0 * (i + 0.5) / M - 1.0)
                        moves[i] = 0.0
                    limit[i] = max(f_s * (1.0 + r * noise[0, k, i]), 0.2 * f_s, f_d)
                    stray[i] = 0.0
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
        for j in range(len(lags)):
            old = past[(row - lags[j]) % (p + 1)]
            for i in range(M):
                e[i] -= turns[j] * old[i]
        sums += kept
        past[row % (p + 1)] = sums
        if row < p:
            continue
        mixed = 0.0
        for i in range(M):
            g[i] = seen[k - born[i]] if S > 0.0 else 0.0
        for i in range(M):
            e[i] -= g[i] * off[i]
            taken = g[i] * unsure[i]
            spread = s * s + g[i] * taken
            far = away[i] = e[i] * e[i] / spread
            likely = 1.0 / (1.0 + far / NU)
            kept[i] = w[i] * likely * likely * likely * s / math.sqrt(spread) + 1e-300
            takes_in = taken / (spread + s * s * max(0.0, far - 1.0) / (NU + 1.0))  # what is far off tells less
            off[i] += takes_in * e[i]
            unsure[i] *= 1.0 - takes_in * g[i]
        for i in range(M):  # apart, for the processor takes several stems at once above
            mixed += kept[i]
            best = min(best, away[i])
        each[row] = math.log(mixed) + NORMAL - math.log(s)
        if S <= 0.0:
            continue
        uneven = 0.0
        for i in range(M):
            w[i] = kept[i] / mixed
            uneven += w[i] ** 2
        lost = best > LOST * LOST
        if uneven * M * EVEN < 1.0 and not lost:
            continue
        _chosen(w, heirs)
        gone = 0
        j = 0
        for i in range(M):  # who has heirs stays where it is, and its other heirs take the places of those without
            if heirs[i] == 0:
                while heirs[j] < 2:
                    j += 1
                heirs[j] -= 1
                places[gone], parents[row, i] = i, j
                gone += 1
        w[:] = 1.0 / M
        for own in (x, one, two, way, moves, limit, off, unsure, sums):
            _drawn(own, places[:gone], parents[row])
        for i in places[:gone]:
            born[i] = born[parents[row, i]]
        for j in range(slots):
            _drawn(ring[j], places[:gone], parents[row])
        for j in range(p + 1):
            _drawn(past[j], places[:gone], parents[row])
        moving, astray = 0, lost
        for i in range(M):
            b = f_s * (1.0 + r * noise[0, k, i])
            if b > abs(u[k] - x[i] - off[i]):  # a breakaway that this stem may still have
                limit[i] = max(b, f_d)
            if lost and i % 2 == 0:
                stray[i] = 1.0
            moving += moves[i] > 0.0
    i = int(np.argmax(w))
    o = off[i]
    for k in range(n * q - 1, -1, -1):
        if (k + 1) % q == 0:
            i = parents[k // q, i]
        shown[0, k] = stems[k, i] + o
        if not math.isnan(was_off[k, i]):
            o = was_off[k, i]
    _answer(begun[i], whole, share, keeps, takes, keeps_2, blends, 0.0 if integrating else begun[i], shown)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _steps(integrating: bool, tau: float, tau_2: float, dt: float) -> Any:
    """What the first lag keeps and takes in, what the second keeps, and how much of the old first one it sees."""
    a = math.exp(-dt / tau)
    keeps, takes = (1.0, dt) if integrating else (a, 1.0 - a)
    return (keeps, takes, math.exp(-dt / tau_2), 0.5) if tau_2 > 0.0 else (keeps, takes, 0.0, 0.0)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _step_tables(  # type: ignore[no-untyped-def]
    n, q, K, lags, turns, whole, share, keeps, takes, keeps_2, blends
) -> Any:
    """What a step of the stem by 1 gives by its age in samples (n,).

    The first and the second lag, the sum of the second, the sum of PV's rows if one ends then, and that row's error.
    """
    first, second, summed, rows, seen = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    for k in range(1, n):
        at, before = 1.0 * (k > whole), 1.0 * (k > whole + 1)
        first[k] = keeps * first[k - 1] + takes * ((1.0 - share) * at + share * before)
        second[k] = keeps_2 * second[k - 1] + (1.0 - keeps_2) * (blends * first[k - 1] + (1.0 - blends) * first[k])
        summed[k] = summed[k - 1] + second[k]
        seen[k] = K * (summed[k] - (summed[k - q] if k > q else 0.0)) / q
        rows[k] = seen[k] + (rows[k - q] if k > q else 0.0)
        for j in range(len(lags)):
            if k > lags[j] * q:
                seen[k] -= turns[j] * rows[k - lags[j] * q]
    return first, second, summed, rows, seen


@njit(cache=True)  # type: ignore[untyped-decorator]
def _chosen(w: Any, heirs: Any) -> None:
    """How many heirs each stem of weights w (M,) has, evenly spaced along the sum of weights."""
    j, reached, M = 0, w[0], len(w)
    heirs[:] = 0
    for i in range(M):
        while reached < (i + 0.5) / M and j < M - 1:
            j += 1
            reached += w[j]
        heirs[j] += 1


@njit(cache=True)  # type: ignore[untyped-decorator]
def _drawn(values: Any, places: Any, parents: Any) -> None:
    """Give each of the ``places`` the value of the stem that goes on there."""
    for i in places:
        values[i] = values[parents[i]]


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
