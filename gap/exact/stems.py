"""The likelihood of a log whose valve sticks, in a loop that is linear else: a bank of stems that no log shows.

Each stem draws what the controllers give at each scan, which its own Kalman filter then knows: so what a valve is told
has the spread, and the memory, that noise and loads give it.  Given that, the stem is known and the rest is linear, so
that all stems have the same gains.  Rows are far apart in scans, and they tell afterwards what the loop did between
them: a draw of OP is led by the next row,

    OP_k ~ N(mean, q_k)          led: N(mean + g (Y - what the next row is expected to be), p_k)

as if the stem stayed where it is until then, and pays for it in its weight, the ratio of both densities.

    a stem sticks at x until |command - x| > (S + J)/2, and then stands at command -+ (S - J)/2

At a row     w_i <- w_i N(miss_i; 0, s_i),      likelihood of the row = sum w_i N(miss_i; 0, s_i)

and stems are drawn again where the weights are uneven.  Where even the best stem misses a row by far, half of them are
put anywhere within the band in which a stem can stick, for a charge.  With the same random numbers for all sizes the
likelihood is smooth in them.
Source: Rao-Blackwellised particle filter, Doucet, de Freitas, Murphy and Russell (UAI 2000); systematic resampling:
Kitagawa, J. Computational and Graphical Statistics 5 (1996), appendix.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.exact.kalman import measurement_update, time_update
from stickslip.gap.exact.scanned import Scanned
from stickslip.gap.null_model.modes import CHARGE
from stickslip.logs.arrays import Values
from stickslip.logs.compiled import njit

FAR = 2.5  # standard deviations of OP beyond which the next row does not lead a stem
LEAST = 1e-6  # share of a variance that is left
REPEATS = (
    0.02  # standard deviation of the breakaway from stem to stem, as a share: no friction repeats to the last digit
)
EVEN = 0.5  # share of the stems that must count
LOST = 5.0  # standard deviations by which even the best stem misses a row where none has the right mode
TURNS = 80  # rows after which gains have settled


def left_by_stems(
    one: Scanned,
    u: Values,
    every: int,
    Y: Values,
    r: Values,
    S: float,
    J: float,
    count: int,
    seed: int,
    again: NDArray[np.int64] | None = None,
) -> tuple[Values, Values, Values]:
    """Return deviates of the innovations (rows, signals), the loss of each row [nats], and where one likely stem stood
    at each scan.

    ``one`` a diagram cut at the stem, ``u`` its inputs at each scan; a row of ``Y`` comes ``every`` scans, with the
    variance of rounding ``r``; ``S``, ``J`` in the unit of the stem; ``count`` stems, ``seed`` of their numbers;
    ``again`` (rows, signals) which controller begins anew at a row as its output is logged, -1 for none: it may have
    been at a limit before.
    """
    assert one.command is not None
    draws, turns, repeats = _numbers(seed, count, len(u), len(one.v), len(Y))
    n, C = one.n, len(one.v)
    free = np.zeros((C, n))
    for c in range(C):
        free[c] = one.v[c, :n] + one.v[c, n : n + C] @ free
    seen = one.H[:, :n] + one.H[:, n : n + C] @ free
    follows = one.F[:, :n] + one.F[:, n : n + C] @ free
    G, b, R = _ahead(one, seen, follows, r, every)
    K, s, of_OP, q = np.zeros((len(seen), n)), np.ones(len(seen)), np.zeros((every, C, n)), np.zeros((every, C))
    g, p, moved = np.zeros((every, C, len(seen))), np.zeros((every, C)), np.zeros((every, C, len(seen)))
    held, v = np.ascontiguousarray(one.F[:, :n]), np.ascontiguousarray(one.v[:, :n])
    _settled(held, one.Q, seen, r, v, every, G, R, K, s, of_OP, q, g, p, moved)
    known = _known(one, u, seen, follows, every, len(Y))
    again = np.full(Y.shape, -1) if again is None else again
    kept = np.array([one.memory[np.argmax(one.of == c)] if (one.of == c).any() else one.last[c] for c in range(C)])
    below, losses = np.empty(Y.shape), np.empty(len(Y))
    stood, came = np.empty((len(u), count), dtype=np.float32), np.empty((len(Y), count), dtype=np.int32)
    _banked(one.F, one.v, one.command, one.H, one.last, one.start, u, Y, every, K, s, of_OP, q, G, b, g, p, moved,
            known, float(S), float(J), draws, turns, repeats, again, kept, below, losses, stood, came)  # fmt: skip
    row_of = np.full(len(u), -1)
    row_of[::every] = np.arange(len(Y))
    return _deviates(below), losses, likely_path(stood, came, row_of)


@lru_cache(maxsize=1)
def _numbers(seed: int, count: int, scans: int, controllers: int, rows: int) -> tuple[Values, Values, Values]:
    """Return the random numbers of a bank: draws of OP, (scans, controllers, stems), of rows and of breakaways."""
    rng = np.random.default_rng([seed, count])
    draws, turns = rng.normal(size=(scans, controllers, count)), rng.random(rows)
    return draws, turns, 1.0 + REPEATS * rng.normal(size=count)


def _ahead(one: Scanned, seen: Values, follows: Values, r: Values, every: int) -> tuple[Values, Values, Values]:
    """Return how the next row follows z and a stem that stays at each scan before it, and the variance of the rest."""
    at_mv = one.n + len(one.v)
    G, b, R = np.empty((every, *seen.shape)), np.empty((every, len(seen))), np.empty((every, len(seen), len(seen)))
    later, of_stem, unsure = seen, np.zeros(len(seen)), np.diag(r)
    for k in range(every - 1, -1, -1):
        of_stem = of_stem + later @ one.F[:, at_mv]
        unsure = unsure + later @ one.Q @ later.T
        later = later @ follows
        G[k], b[k], R[k] = later, of_stem, unsure
    return G, b, R


def _known(one: Scanned, u: Values, seen: Values, follows: Values, every: int, rows: int) -> Values:
    """Return what inputs alone make of the row behind each row, (rows, signals)."""
    n, C = one.n, len(one.v)
    OP = np.zeros((C, len(u)))
    for c in range(C):
        OP[c] = u @ one.v[c, n + C + 1 :] + one.v[c, n : n + c] @ OP[:c]
    push = one.F[:, n + C + 1 :] @ u.T + one.F[:, n : n + C] @ OP
    at_once = one.H[:, n + C + 1 :] @ u.T + one.H[:, n : n + C] @ OP
    starts, found, later = every * np.arange(rows - 1), np.zeros((rows, len(seen))), seen
    found[: rows - 1] = at_once[:, starts + every].T
    for k in range(every - 1, -1, -1):
        found[: rows - 1] += (later @ push[:, starts + k]).T
        later = later @ follows
    return found


def likely_path(stood: NDArray[np.floating], came: NDArray[np.integer], row_of: NDArray[np.int64]) -> Values:
    """Return where one likely stem of a bank stood at each stop.

    ``stood`` (stops, stems) where each was, ``came`` (rows, stems) of which stem each came behind a row, ``row_of`` the
    row at each stop, -1 for none.
    """
    found, j = np.empty(len(stood)), 0
    for k in range(len(stood) - 1, -1, -1):
        found[k] = stood[k, j]
        if row_of[k] >= 0:
            j = int(came[row_of[k], j])
    return found


def _deviates(below: Values) -> Values:
    """Return the normal deviates of shares below them."""
    from scipy.special import ndtri

    return np.asarray(ndtri(np.clip(below, 1e-15, 1.0 - 1e-15)))


@njit(cache=True, inner=True, error_model="numpy")
def normal(x):  # type: ignore[no-untyped-def]
    """Return the distribution function of a normal deviate."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


@njit(cache=True, error_model="numpy")
def stuck(x, command, S, J, repeats):  # type: ignore[no-untyped-def]
    """Return where a stem stands after its input has become an opening; ``repeats`` is its breakaway over the mean
    one.
    """
    pull = command - x
    if abs(pull) > max(0.5 * (S + J) * repeats, 0.5 * (S - J)):
        return command - math.copysign(0.5 * (S - J), pull)
    return x


@njit(cache=True, error_model="numpy")
def _settled(A, Q, H, r, v, every, G, R, K, s, of_OP, q, g, p, moved):  # type: ignore[no-untyped-def]
    """Write gains and variances of rows, ``K`` and ``s``, of OP at each scan, ``of_OP`` and ``q``, and what leads OP.

    ``moved``: what drawing OP changes in what is expected of the next row, (every, controllers, signals).
    """
    P, room = np.eye(len(Q)) * 1e-4, np.empty((len(Q), len(Q)))
    for _ in range(TURNS):
        for k in range(every):
            if k == 0:
                for j in range(len(H)):
                    s[j] = measurement_update(P, H[j], r[j], K[j])
            for c in range(len(v)):
                seen = G[k] @ P
                cross = seen @ v[c]
                g[k, c] = np.linalg.solve(seen @ G[k].T + R[k], cross)
                q[k, c] = measurement_update(P, v[c], 0.0, of_OP[k, c])
                p[k, c] = max(q[k, c] - g[k, c] @ cross, LEAST * q[k, c])
                moved[k, c] = G[k] @ of_OP[k, c]
            time_update(P, A, Q, room)


@njit(cache=True, inner=True, error_model="numpy")
def _summed(row, R, u, out):  # type: ignore[no-untyped-def]
    """Write ``row`` times what each stem has, ``R`` (states, stems), and times what all share, ``u``."""
    out[:] = 0.0
    for p in range(len(R)):
        if row[p] != 0.0:
            by = row[p]
            for i in range(len(out)):
                out[i] += by * R[p, i]
    shared = 0.0
    for p in range(len(u)):
        shared += row[len(R) + p] * u[p]
    out += shared


@njit(cache=True, inner=True, error_model="numpy")
def _weighed(w, more, largest):  # type: ignore[no-untyped-def]
    """Multiply weights by exp(more), ``largest`` its largest; return the logarithm of their sum, which is 1 then.

    ``more`` is used up: it holds the factors behind.
    """
    total = 0.0
    for i in range(len(w)):
        more[i] = math.exp(more[i] - largest)
        total += w[i] * more[i]
    if not total > 0.0:  # every stem that counted is excluded: none counts more than another
        w[:] = 1.0 / len(w)
        for i in range(len(w)):
            total += w[i] * more[i]
    for i in range(len(w)):
        w[i] *= more[i] / total
    return largest + math.log(total)


@njit(cache=True, error_model="numpy")
def _banked(  # type: ignore[no-untyped-def]
    F, v, command, H, last, start, U, Y, every, K, s, of_OP, q, G, b, g, p, moved, known, S, J, draws, turns, repeats,
    again, kept, e, loss, stood, came,
):  # fmt: skip
    """Write shares below each innovation, ``e`` (rows, signals), the loss of each row [nats], where each stem ``stood``
    at each scan, and of which stem each ``came`` behind a row.
    """
    n, C, M, m = len(start), len(v), draws.shape[2], len(H)
    at_mv = n + C
    R, new, guess, opening = np.empty((at_mv + 1, M)), np.empty((n, M)), np.empty(M), np.empty(M)
    z, x, w, paid = R[:n], R[at_mv], np.full(M, 1.0 / M), np.zeros(M)
    miss, other, gaps, lost, led = np.empty(M), np.empty((at_mv + 1, M)), np.zeros((m, M)), False, False
    for i in range(n):
        z[i] = start[i]
    for c in range(C):
        R[n + c] = start[last[c]]
    R[at_mv] = 0.0
    _summed(command, R, U[0], opening)
    for i in range(M):
        x[i] = opening[i] + 0.45 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
    for k in range(len(U)):
        phase = k % every
        if phase == 0:
            at = k // every
            loss[at], lost = -_weighed(w, paid, paid.max()), False
            for c in range(C):
                R[n + c] = 0.0
            for j in range(m):
                e[at, j] = np.nan
                if not np.isfinite(Y[at, j]):
                    continue
                for c in range(C):
                    for d in range(c, C):
                        R[n + d] = 0.0
                    _summed(v[c], R, U[k], guess)
                    R[n + c] = guess
                _summed(H[j], R, U[k], guess)
                c = again[at, j]
                if c >= 0:
                    for i in range(M):
                        z[kept[c], i] += (Y[at, j] - guess[i]) / v[c, kept[c]]
                    continue
                below, largest = 0.0, -np.inf
                for i in range(M):
                    guess[i] = Y[at, j] - guess[i]
                    below += w[i] * normal(guess[i] / math.sqrt(s[j]))
                    miss[i] = -0.5 * guess[i] ** 2 / s[j]
                    largest = max(largest, miss[i])
                lost = lost or largest < -0.5 * LOST**2
                for a in range(n):
                    for i in range(M):
                        z[a, i] += K[j, a] * guess[i]
                loss[at] += 0.5 * math.log(s[j]) - _weighed(w, miss, largest)
                e[at, j] = below
            even = 0.0
            for i in range(M):
                even += w[i] ** 2
                came[at, i] = i
            if lost:
                loss[at] += CHARGE
            if lost or 1.0 / even < EVEN * M:
                passed, i = w[0], 0
                for a in range(M):
                    share = (a + turns[at]) / M
                    while passed < share and i < M - 1:
                        i += 1
                        passed += w[i]
                    other[:, a] = R[:, i]
                    came[at, a] = i
                R[:] = other
                w[:] = 1.0 / M
            paid[:] = 0.0
            led = at + 1 < len(Y)
            for j in range(m if led else 0):
                led = led and np.isfinite(Y[at + 1, j]) and again[at + 1, j] < 0
            for j in range(m if led else 0):
                for i in range(M):
                    gaps[j, i] = Y[at + 1, j] - known[at, j] - b[0, j] * x[i]
                for a in range(n):
                    for i in range(M):
                        gaps[j, i] -= G[0, j, a] * z[a, i]
        for c in range(C):
            for d in range(c, C):
                R[n + d] = 0.0
            _summed(v[c], R, U[k], opening)
            wide, narrow = math.sqrt(q[phase, c]), math.sqrt(p[phase, c])
            for i in range(M):
                guess[i] = wide * draws[k, c, i]
                shift = 0.0
                for j in range(m if led else 0):
                    shift += g[phase, c, j] * gaps[j, i]
                if led and abs(shift) < FAR * wide:
                    guess[i] = shift + narrow * draws[k, c, i]
                    paid[i] += 0.5 * draws[k, c, i] ** 2 - 0.5 * (guess[i] / wide) ** 2 + math.log(narrow / wide)
                for j in range(m if led else 0):
                    gaps[j, i] -= moved[phase, c, j] * guess[i]
                R[n + c, i] = opening[i] + guess[i]
            for a in range(n):
                for i in range(M):
                    z[a, i] += of_OP[phase, c, a] * guess[i]
        _summed(command, R, U[k], opening)
        for i in range(1, M if phase == 0 and lost else 0, 2):
            x[i] = opening[i] + 0.5 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
        for i in range(M):
            before = x[i]
            x[i] = stuck(before, opening[i], S, J, repeats[i])
            stood[k, i] = x[i]
            for j in range(m if led else 0):
                gaps[j, i] -= b[phase, j] * (x[i] - before)
        for a in range(n):
            _summed(F[a], R, U[k], new[a])
        z[:] = new
