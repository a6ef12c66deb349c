"""A bank of stems that draws OP at each scan: exact, at the price of many stems.

Given OP at each scan and the path of a stem, all else is linear with normal noise.  So each stem draws OP from what its
filter knows, takes it in as if it were seen, and moves as it is told; the covariance P is then the same for all.

    OP ~ N(v z, q),   q = v P v',   z <- z + P v' (OP - v z) / q,   P <- P - P v' v P / q

Most of what could be drawn blindly is excluded by the next row.  So OP is drawn given that row too, as if the stem
stayed where it is, and what this prefers is taken back by the weight (Doucet, Godsill and Andrieu 2000):

    OP ~ N(v z + d, p),   d = g (y - G z - b x),   w <- w N(OP; v z, q) / N(OP; v z + d, p)

y the next row, G z + b x what is expected of it, g = v P G' (G P G' + R)^-1,  p = q - g G P v'.  A stem that a row
finds elsewhere by far is not led (``FAR``).  ``stems`` is smooth with few stems, but has only a part of what OP does
between two rows: of what a jump of a third of S tells it sees an eighth (tuning record 8503 of the site loop).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.kalman import looked, spread
from stickslip.gap.filters.passing import along
from stickslip.gap.filters.scanned import Scanned
from stickslip.gap.filters.stems import EVEN, LOST, deviates, normal, stuck, summed, told_by
from stickslip.gap.floors.modes import CHARGE
from stickslip.gap.insertion.inserted import percent_in
from stickslip.logs.compiled import njit

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
FAR = 2.5  # standard deviations of OP beyond which the next row does not lead a stem
LEAST = 1e-6  # share of a variance that is left
REPEATS = 0.02  # standard deviation of the breakaway from stem to stem, as a share
NEAR = 0.002  # of a controller's span: an output so near a limit says nothing


@dataclass(frozen=True, eq=False)
class Draws:
    """The random numbers of a bank, the same for all sizes: (scans, controllers, stems), (rows,) and (stems,)."""

    of_OP: Floats
    turns: Floats
    repeats: Floats

    @classmethod
    def of(cls, one: Explanation, count: int, seed: int = 0) -> "Draws":
        """Return numbers for so many stems."""
        f, rng = one.filtering, np.random.default_rng([seed, count])
        draws = rng.normal(size=(f.scans, len(f.controllers), count))
        return cls(draws, rng.random(len(f.Y)), 1.0 + REPEATS * rng.normal(size=count))


def drawn(one: Explanation, values: Mapping[str, float], draws: Draws) -> Filtered:
    """Return what a bank of stems of these sizes leaves that draws OP at each scan."""
    f = one.filtering
    full = {**one.nominal, **values}
    percent = percent_in(f.quiet, one.place)
    S = full["width" if isinstance(one.effect, Deadband) else "S"] * percent
    J = 0.0 if isinstance(one.effect, Deadband) else full["J"] * percent
    m = one.matrices(full)
    if m.told is None:
        raise ValueError("a bank needs a cut at the valve")
    n, C, kinds = m.n, len(m.v), len(f.signals)
    U = np.column_stack([f.played, f.time, np.ones(f.scans), np.zeros(f.scans)])
    seen = np.stack([m.free[c] if c >= 0 else m.shown[j] for j, c in enumerate(f.acts)])
    held, follows = np.ascontiguousarray(m.F[:, :n]), m.F[:, :n] + m.F[:, n : n + C] @ m.free
    G, b, R = _ahead(m, seen, follows, f.r, f.every)
    K, s, of_OP, q = np.zeros((kinds, n)), np.ones(kinds), np.zeros((f.every, C, n)), np.zeros((f.every, C))
    g, p, moved = np.zeros((f.every, C, kinds)), np.zeros((f.every, C)), np.zeros((f.every, C, kinds))
    v = np.ascontiguousarray(m.v[:, :n])
    settled(held, m.Q, seen, f.r, v, f.every, G, R, K, s, of_OP, q, g, p, moved)
    known = _known(m, U, seen, follows, f.every, f.acts)
    e, loss, path = np.empty(f.Y.shape), np.empty(len(f.Y)), np.empty(len(f.Y))
    _drawn(
        m.F, m.v, m.told, m.H, m.limits, m.memory, m.of, m.beyond, m.last, m.start, U, f.Y, f.acts, f.every, K, s,
        of_OP, q, G, b, g, p, moved, known, S, J, draws.of_OP, draws.turns, draws.repeats, e, loss, path,
    )  # fmt: skip
    e = deviates(e)
    return Filtered(one, full, e, np.where(np.isnan(e), np.nan, 1.0), path, loss)


def _ahead(m: Scanned, seen: Floats, follows: Floats, r: Floats, every: int) -> tuple[Floats, Floats, Floats]:
    """Return how the next row follows z and a stem that stays at each scan before it, and the variance of the rest."""
    kinds, at_mv = len(seen), m.n + len(m.v)
    G, b, R = np.empty((every, kinds, m.n)), np.empty((every, kinds)), np.empty((every, kinds, kinds))
    later, of_stem, unsure = seen, np.zeros(kinds), np.diag(r)
    for k in range(every - 1, -1, -1):
        of_stem = of_stem + later @ m.F[:, at_mv]
        unsure = unsure + later @ m.Q @ later.T
        later = later @ follows
        G[k], b[k], R[k] = later, of_stem, unsure
    return G, b, R


def _known(m: Scanned, U: Floats, seen: Floats, follows: Floats, every: int, acts: Whole) -> Floats:
    """Return what inputs alone make of the row behind each row, (rows, signals)."""
    n, C = m.n, len(m.v)
    OP = np.zeros((C, len(U)))
    for c in range(C):
        OP[c] = U @ m.v[c, n + C + 1 :] + m.v[c, n : n + c] @ OP[:c]
    push = m.F[:, n + C + 1 :] @ U.T + m.F[:, n : n + C] @ OP
    at_once = np.stack([
        OP[c] if c >= 0 else m.H[j, n + C + 1 :] @ U.T + m.H[j, n : n + C] @ OP for j, c in enumerate(acts)
    ])  # fmt: skip
    rows = (len(U) - 1) // every
    starts, found, later = every * np.arange(rows), np.zeros((rows + 1, len(seen))), seen
    found[:rows] = at_once[:, starts + every].T
    for k in range(every - 1, -1, -1):
        found[:rows] += (later @ push[:, starts + k]).T
        later = later @ follows
    return found


@njit(cache=True)
def settled(A, Q, H, r, v, every, G, R, K, s, of_OP, q, g, p, moved):  # type: ignore[no-untyped-def]
    """Write gains and variances of rows, ``K`` and ``s``, of OP at each scan, ``of_OP`` and ``q``, and what leads OP.

    ``moved``: what drawing OP changes in what is expected of the next row, (every, controllers, signals).
    """
    P, room = np.eye(len(Q)) * 1e-4, np.empty((len(Q), len(Q)))
    for _ in range(80):
        for k in range(every):
            if k == 0:
                for j in range(len(H)):
                    s[j] = looked(P, H[j], r[j], K[j])
            for c in range(len(v)):
                seen = G[k] @ P
                cross = seen @ v[c]
                g[k, c] = np.linalg.solve(seen @ G[k].T + R[k], cross)
                q[k, c] = looked(P, v[c], 0.0, of_OP[k, c])
                p[k, c] = max(q[k, c] - g[k, c] @ cross, LEAST * q[k, c])
                moved[k, c] = G[k] @ of_OP[k, c]
            spread(P, A, Q, room)


@njit(cache=True)
def _tells(y, acts, limits):  # type: ignore[no-untyped-def]
    """Return whether all signals of a row tell something."""
    found = True
    for j in range(len(y)):
        found = found and np.isfinite(y[j]) and not (acts[j] >= 0 and _limited(y[j], limits[acts[j]]))
    return found


@njit(cache=True)
def _limited(y, limits):  # type: ignore[no-untyped-def]
    """Return whether an output is so near a limit that it says nothing."""
    near = NEAR * (limits[1] - limits[0])
    return y >= limits[1] - near or y <= limits[0] + near


@njit(cache=True)
def _weighed(w, more, largest):  # type: ignore[no-untyped-def]
    """Multiply weights by exp(more), ``largest`` its largest; return the logarithm of their sum, which is 1 then."""
    total = 0.0
    for i in range(len(w)):
        total += w[i] * math.exp(more[i] - largest)
    if not total > 0.0:  # every stem that counted is excluded: none counts more than another
        w[:] = 1.0 / len(w)
        for i in range(len(w)):
            total += w[i] * math.exp(more[i] - largest)
    for i in range(len(w)):
        w[i] *= math.exp(more[i] - largest) / total
    return largest + math.log(total)


@njit(cache=True)
def _drawn(  # type: ignore[no-untyped-def]
    F, v, told, H, limits, memory, of, beyond, last, start, U, Y, acts, every, K, s, of_OP, q, G, b, g, p, moved, known,
    S, J, draws, turns, repeats, e, loss, path,
):  # fmt: skip
    """Write shares below each innovation, ``e`` (rows, signals), the loss of each row [nats] and the mean stem."""
    n, C, M, m = len(start), len(v), draws.shape[2], len(H)
    at_mv = n + C
    R, new, wanted, guess = np.empty((at_mv + 1, M)), np.empty((n, M)), np.empty((C, M)), np.empty(M)
    z, x, w, paid = R[:n], R[at_mv], np.full(M, 1.0 / M), np.zeros(M)
    miss, other, opening, row = np.empty(M), np.empty((at_mv + 1, M)), np.empty(M), np.zeros(F.shape[1])
    gaps, lost, led = np.zeros((m, M)), False, False
    for i in range(n):
        z[i] = start[i]
    for c in range(C):
        R[n + c] = start[last[c]]
    R[at_mv] = 0.0
    summed(told, R, U[0], opening)
    for i in range(M):
        x[i] = opening[i] + 0.45 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
    for k in range(len(U)):
        phase = k % every
        if phase == 0:
            at = k // every
            loss[at], lost = -_weighed(w, paid, paid.max()), False
            for j in range(m):
                e[at, j] = np.nan
                c = acts[j]
                if not np.isfinite(Y[at, j]) or (c >= 0 and _limited(Y[at, j], limits[c])):
                    continue
                told_by(v, limits, U[k], R, n, wanted)
                if c >= 0:
                    guess[:] = wanted[c]
                else:
                    summed(H[j], R, U[k], guess)
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
            path[at], even = 0.0, 0.0
            for i in range(M):
                path[at] += w[i] * x[i]
                even += w[i] ** 2
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
                R[:] = other
                w[:] = 1.0 / M
            paid[:] = 0.0
            led = at + 1 < len(Y) and _tells(Y[min(at + 1, len(Y) - 1)], acts, limits)
            for j in range(m if led else 0):
                for i in range(M):
                    gaps[j, i] = Y[at + 1, j] - known[at, j] - b[0, j] * x[i]
                for a in range(n):
                    for i in range(M):
                        gaps[j, i] -= G[0, j, a] * z[a, i]
        for c in range(C):
            for d in range(c, C):
                R[n + d] = 0.0
            summed(v[c], R, U[k], wanted[c])
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
                wanted[c, i] += guess[i]
                R[n + c, i] = min(max(wanted[c, i], limits[c, 0]), limits[c, 1])
            for a in range(n):
                for i in range(M):
                    z[a, i] += of_OP[phase, c, a] * guess[i]
        summed(told, R, U[k], opening)
        for i in range(1, M if phase == 0 and lost else 0, 2):
            x[i] = opening[i] + 0.5 * (S + J) * (2.0 * (i + 0.5) / M - 1.0)
        for i in range(M):
            stood = x[i]
            x[i] = stuck(stood, opening[i], S, J, repeats[i])
            for j in range(m if led else 0):
                gaps[j, i] -= b[phase, j] * (x[i] - stood)
        for a in range(n):
            summed(F[a], R, U[k], new[a])
        for c in range(C):
            for i in range(M):
                if R[n + c, i] != wanted[c, i]:
                    row[: at_mv + 1] = R[:, i]
                    row[at_mv + 1 :] = U[k]
                    side, push = 0 if wanted[c, i] > R[n + c, i] else 1, -1
                    for a in range(len(memory)):
                        if of[a] == c:
                            if push < 0:
                                push = 0 if (new[memory[a], i] > z[memory[a], i]) == (side == 0) else 1
                            new[memory[a], i] = along(beyond[side, push, a], row)
        z[:] = new
