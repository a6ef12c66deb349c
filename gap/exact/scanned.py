"""A linear diagram from one scan to the next, as matrices.

    s_k  = S z_k + S_in u_k + S_op OP_k                signals just after scan k
    z_k+1 = F z_k + F_in u_k + F_op OP_k + w_k          w_k ~ N(0, Q), independent

z: states of continuous blocks, memories of sampled ones, loads and noise in force, values on their way through dead
times, the last OPs.  u: logged inputs, the time, 1.  OP is what each controller gives, the outer one of a cascade
first; one that scans more slowly holds its last between its scans, and its memories.  Between scans nothing but
continuous blocks moves, under held inputs, so the matrices are exact (matrix exponential); what passes a dead time
while it moves is held at its mean.

Where a valve is ``cut``, what its stem makes of the opening that it is told is an input as well, MV.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from stickslip.blocks.block import Block
from stickslip.gap.exact.affine import Affine, NotAffine, affine
from stickslip.gap.exact.operating import ONLOOKERS, inside
from stickslip.gap.records.model import Nuisance
from stickslip.logs.arrays import Values

Whole = NDArray[np.int64]
LATE = 100  # scans of dead time at most: each is one more z, and the work grows with the cube of their number


@dataclass(frozen=True, eq=False)
class Scanned:
    """Matrices over the columns [z, OPs, u]: one of u for each ``kind``, the logged inputs, the time and 1.  Where a
    valve is cut they are [z, OPs, MV, u], and ``command`` is the opening that the valve is sent.

    ``F`` next z; ``v`` what controllers give, (controllers, columns), each follows those before it only; ``H`` logged
    signals; ``Q``; ``memory`` of the controllers, ``of`` which each is; ``last`` where z has the last OPs; ``period``
    and ``offset`` of controllers in scans; ``start`` z at first, ``states`` the names of its first; ``drawn`` which of
    z are loads and noise.
    """

    kinds: tuple[str, ...]
    F: Values
    v: Values
    H: Values
    Q: Values
    memory: Whole
    of: Whole
    last: Whole
    period: Whole
    offset: Whole
    start: Values
    states: tuple[str, ...]
    drawn: Whole
    command: Values | None = None

    @property
    def n(self) -> int:
        """Length of z."""
        return len(self.start)

    def closed(self, k: int) -> tuple[Values, Values]:
        """Return next z, and the logged signals, at scan ``k`` as they follow [z, u], controllers in the loop."""
        n, C = self.n, len(self.v)
        acts = (k - self.offset) % self.period == 0
        given = np.zeros((C, n + len(self.kinds)))
        for c in range(C):
            if acts[c]:
                given[c] = np.delete(self.v[c], np.s_[n : n + C]) + self.v[c, n : n + C] @ given
            else:
                given[c, self.last[c]] = 1.0
        F, H = (np.delete(M, np.s_[n : n + C], axis=1) + M[:, n : n + C] @ given for M in (self.F, self.H))
        held = self.memory[~acts[self.of]] if len(self.of) else self.memory
        F[held] = 0.0
        F[held, held] = 1.0
        return F, H


def scanned(
    blocks: Sequence[Block],
    noise: Sequence[Nuisance],
    controllers: Sequence[str],
    logged: Sequence[str],
    inputs: Sequence[str],
    near: Mapping[str, float],
    period: float,
    cut: str = "",
) -> Scanned:
    """Return the matrices of the blocks of a silent diagram.

    ``noise`` its nuisances with their sizes; ``controllers`` the blocks that scan and act, the outer one of a cascade
    first; ``logged`` signals to observe, ``inputs`` open inputs; ``near`` the value of each signal (``operating``), at
    no limit; ``period`` of a scan [s]; ``cut`` the signal of a stem.
    Raises ``NotAffine`` if a block bends, delays by more than ``LATE`` scans, or scans at times of its own.
    """
    h = period
    blocks = [b for b in blocks if b.role not in ONLOOKERS]
    named = {b.name: b for b in blocks}
    signals = [*(str(s) for b in blocks for s in b.output_labels), *inputs]
    place = {s: i for i, s in enumerate(signals)}
    if len(place) < len(signals) or any(str(s) not in place for b in blocks for s in b.input_labels):
        raise NotAffine("an input is not logged")
    acting = [named[name] for name in controllers]
    ops = [str(b.output_labels[0]) for b in acting]
    periods, offsets = _scans(blocks, acting, h)
    at = np.array([near[s] for s in signals])
    tables = [affine(inside(b, near), at[[place[str(s)] for s in b.input_labels]]) for b in blocks]

    # --- columns of what everything is made of
    own = [(b.name, s) for b, a in zip(blocks, tables, strict=True) for s in a.states]
    late = [(b, *divmod(b.dead_time, h)) for b in blocks if b.dead_time > 0.0]
    names = [*(f"{b}.{s}" for b, s in own), *(f"{one.block} noise" for one in noise)]
    lines = []
    for b, whole, rest in late:
        if whole > LATE:
            raise NotAffine(f"'{b.name}' delays by {whole:.0f} scans, more than {LATE}: its filter would take too long")
        for i in range(len(b.input_labels)):
            length = round(whole) + (1 if rest > 1e-9 else 0)
            lines.append((b.name, i, len(names), length, rest if rest > 1e-9 else 0.0))
            names += [f"{b.name} input {i} late {j + 1}" for j in range(length)]
    last = len(names) + np.arange(len(ops))
    names += [f"last {s}" for s in ops]
    n, kinds = len(names), (*inputs, "t", "1")
    at_in = n + len(ops) + (1 if cut else 0)
    N = at_in + len(kinds)
    unit = np.eye(N)
    in_force: dict[str, Values] = {}
    for j, one in enumerate(noise):
        in_force[one.block] = in_force.get(one.block, 0.0) + unit[len(own) + j]
    delayed = {(name, i): unit[first + length - 1] for name, i, first, length, _ in lines}

    # --- signals just after a scan: s = G s + r
    G, r = np.zeros((len(signals), len(signals))), np.zeros((len(signals), N))
    first = 0
    rows_of = {}
    for b, a in zip(blocks, tables, strict=True):
        k, m = len(a.states), len(b.input_labels)
        rows_of[b.name] = first, k, a, b
        for row, s in zip(a.given, b.output_labels, strict=True):
            i = place[str(s)]
            r[i] += row[:k] @ unit[first : first + k] + row[k + m] * unit[at_in + len(inputs)]
            r[i] += row[k + m + 1] * unit[at_in + len(inputs) + 1]
            for j, source in enumerate(b.input_labels):
                if (b.name, j) in delayed:
                    r[i] += row[k + j] * delayed[b.name, j]
                else:
                    G[i, place[str(source)]] += row[k + j]
            if b.name in in_force:
                r[i] += in_force[b.name]
        first += k
    for j, s in enumerate(inputs):
        r[place[s]] = unit[at_in + j]
    raw_G, raw_r = G.copy(), r.copy()
    for c, s in enumerate(ops):
        G[place[s]], r[place[s]] = 0.0, unit[n + c]
    if cut:
        G[place[cut]], r[place[cut]] = 0.0, unit[n + len(ops)]
    s_now: Values = np.asarray(np.linalg.solve(np.eye(len(signals)) - G, r), dtype=float)
    given = raw_G @ s_now + raw_r  # what controllers give now
    F = np.zeros((n, N))
    for b in blocks:
        first, k, a, _ = rows_of[b.name]
        if b.sampled and k:
            F[first : first + k] = _moved(b, a, first, s_now, unit, place, delayed, at_in + len(inputs))

    # --- between scans: continuous states under held inputs
    moving = [(b, *rows_of[b.name][:2]) for b in blocks if not b.sampled and rows_of[b.name][1]]
    index = [first + j for _, first, k in moving for j in range(k)]
    still = s_now.copy()
    G_c = G.copy()
    for b in blocks:
        if b.sampled:
            for s in b.output_labels:
                G_c[place[str(s)]] = 0.0
    direct = np.zeros((len(signals), len(index)))
    for b, first, k in moving:
        a = rows_of[b.name][2]
        for row, s in zip(a.given, b.output_labels, strict=True):
            if str(s) not in (*ops, cut):
                for j in range(k):
                    direct[place[str(s)], index.index(first + j)] = row[j]
    # a signal between scans = still + free (x - x_k): sampled outputs are held
    free: Values = np.asarray(np.linalg.solve(np.eye(len(signals)) - G_c, direct), dtype=float)
    A = np.zeros((len(index), len(index)))
    rate = np.zeros((len(index), N))  # at x = x_k, delayed inputs as at the scan
    late_part: dict[tuple[str, int], Values] = {}
    row0 = 0
    for b, first, k in moving:
        a = rows_of[b.name][2]
        m = len(b.input_labels)
        for i in range(k):
            row = a.moved[i]
            rate[row0 + i] = row[:k] @ unit[first : first + k] + row[k + m] * unit[at_in + len(inputs)]
            rate[row0 + i] += row[k + m + 1] * unit[at_in + len(inputs) + 1]
            A[row0 + i, [index.index(first + j) for j in range(k)]] += row[:k]
            for j, source in enumerate(b.input_labels):
                if (b.name, j) in delayed:
                    rate[row0 + i] += row[k + j] * delayed[b.name, j]
                    late_part.setdefault((b.name, j), np.zeros(len(index)))[row0 + i] += row[k + j]
                else:
                    rate[row0 + i] += row[k + j] * still[place[str(source)]]
                    A[row0 + i] += row[k + j] * free[place[str(source)]]
        row0 += k
    if index:
        grown = _held(A, h)
        F[index] = unit[index] + grown @ rate
    for name, which, first, length, rest in lines:
        entering = place[str(named[name].input_labels[which])]
        now = s_now[entering]
        if index:
            at_end = now + free[entering] @ (F[index] - unit[index])
            now = 0.5 * (now + at_end)
        F[first] = now
        for j in range(1, length):
            F[first + j] = unit[first + j - 1]
        if rest > 0.0 and (name, which) in late_part:  # after the rest of the scan the next value arrives
            newer = unit[first + length - 2] if length > 1 else now
            F[index] += np.outer(_held(A, h - rest) @ late_part[name, which], newer - unit[first + length - 1])
        elif rest > 0.0:
            raise NotAffine(f"what '{name}' delays by a part of a scan does not enter a block that moves")
    Q = np.zeros((n, n))
    for j, one in enumerate(noise):
        phi = float(np.exp(-h / one.correlation_time)) if one.correlation_time > 0.0 else 0.0
        k = len(own) + j
        F[k, k] = phi
        Q[k, k] = (1.0 - phi**2) * one.sd**2
    F[last, n + np.arange(len(ops))] = 1.0

    memory = [rows_of[b.name][0] + j for b in acting for j in range(rows_of[b.name][1])]
    of = [c for c, b in enumerate(acting) for _ in range(rows_of[b.name][1])]
    start = np.zeros(n)
    for b in blocks:
        first, k, a, _ = rows_of[b.name]
        values = dict(zip(b.seen_states(), b.seen_start(), strict=True))
        start[first : first + k] = [values[s] for s in a.states]
    for name, i, first, length, _ in lines:
        start[first : first + length] = at[place[str(named[name].input_labels[i])]]
    start[last] = at[[place[s] for s in ops]]
    H = np.stack([s_now[place[s]] for s in logged])
    return Scanned(kinds, F, given[[place[s] for s in ops]], H, Q, np.array(memory, dtype=int),
                   np.array(of, dtype=int), last, periods, offsets, start, tuple(f"{b}.{s}" for b, s in own),
                   len(own) + np.arange(len(noise)), given[place[cut]] if cut else None)  # fmt: skip


def _scans(blocks: Sequence[Block], acting: Sequence[Block], h: float) -> tuple[Whole, Whole]:
    """Return period and first scan of each controller, in scans; everything else has to scan at each of them."""
    for b in blocks:
        whole = b in acting and abs(b.period / h - round(b.period / h)) < 1e-6
        if b.sampled and not whole and abs(b.period / h - 1.0) > 1e-6:
            raise NotAffine(
                f"'{b.name}' scans every {b.period:g} s, but only controllers may leave out scans of {h:g} s"
            )
    period = [max(round(b.period / h), 1) for b in acting]
    offset = [round(b.params.get(b.offset_param or "", 0.0) / h) for b in acting]
    return np.array(period), np.array(offset)


def _moved(
    b: Block, a: Affine, first: int, s: Values, unit: Values, place: dict[str, int],
    delayed: dict[tuple[str, int], Values], at_t: int,
) -> Values:  # fmt: skip
    """Return the next memories of a sampled block as rows over all columns."""
    k, m = len(a.states), len(b.input_labels)
    inputs = np.array(
        [delayed[b.name, j] if (b.name, j) in delayed else s[place[str(one)]] for j, one in enumerate(b.input_labels)]
    ).reshape(m, unit.shape[1])
    found: Values = a.moved[:, :k] @ unit[first : first + k] + a.moved[:, k : k + m] @ inputs
    return found + np.outer(a.moved[:, k + m], unit[at_t]) + np.outer(a.moved[:, k + m + 1], unit[at_t + 1])


def _held(A: Values, t: float) -> Values:
    """Return the integral of exp(A s) from 0 to t."""
    n = len(A)
    both = np.zeros((2 * n, 2 * n))
    both[:n, :n], both[:n, n:] = A * t, np.eye(n) * t
    found: Values = expm(both)[:n, n:]
    return found
