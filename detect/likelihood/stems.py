"""One record: the gain [nats] with which a sticking stem predicts PV better than every rival, for each size.

    stick    w = stem of OP, S = 10^(i/8), J/S in {0, 0.4, 1}, three starts where S is large; with a jump both as Kano's
             stem moves, which sticks where OP stops, and as He's, which sticks again after each slip
    rivals   no input; OP; OP with any delay; OP through a bent characteristic; another answer to OP each way; another
             past of PV each way, as a sensor with hysteresis has
    score    log L - p/2 ln n,   p coefficients, and a delay that was chosen; S and J are the valve's, not the record's,
             and are paid for where records are pooled

The order of the past and the tails of the errors are those that suit OP best, without any stick.  Three delays beside
each other are weighed, because what hangs on one of them is no valve: 1, 2, 3, and three up to that which suits OP best
where it is longer.  A stick makes OP like long delays, at which no stick is seen any more; so the short ones stay.
Sizes are powers of one number in the unit of OP, so that those of several days are the same.

OP is made of more than the rows show, where the controller scans several times between two of them or a row is a mean,
and of errors that lie further back.  So OP foretells PV though the valve sticks, and a straight line beats every stick
by that alone.  The same weighing with OP's last moves, u(t-1) - u(t-2) and so on, beside sticks and rivals alike is
free of this (``beside_moves``).  They are moves and not values, because these would be an answer of PV to OP.

Source: the prediction-error likelihood of a loop is textbook (Ljung, System Identification, 1999); rivals and limits
are ours.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from stickslip.detect.likelihood.regression import lines
from stickslip.detect.likelihood.rows import LATEST_ROWS, Rows, past, rows_of
from stickslip.detect.stem.stick import stick
from stickslip.detect.stem.valve_models import he
from stickslip.logs.arrays import Indices, Values

Fitted = tuple[float, Values, Values]  # score, log-likelihood of every row and coefficients
Size = int  # S = 10^(size / FINER)
KANO, HE = 0.0, 1.0
COARSE, FINER = 8, 32  # sizes a decade: looked through, and about the best
SMALLEST, LARGEST = 0.03, 1.5  # S over OP's travel
JUMPS = ((0.0, KANO), (0.4, KANO), (1.0, KANO), (0.4, HE), (1.0, HE))  # J over S, and the law of the stem
STARTS = (-0.9, 0.0, 0.9)  # of f_S (Kano) or f_D (He), where the stem may not move for long
ORDERS = ((3, 3), (6, 5), (10, 8))  # rows of PV's and the input's past
MOVES = 4  # of OP, the last ones; of 1 to 6 on loops of several scans a row (seed 1) and crossed ones (555, 556)
TAILS = (5.0, 3.0, 10.0, 50.0)  # degrees of freedom; the first for the search of order and delay
DELAYS = (1, 2, 3, 4, 6, 8, 11, 15, 20)
NEAR, SURE_NATS = 4, 3.0  # a longer delay than NEAR is believed from so many nats on
LATE = "OP with another delay"
SECTIONS = 10  # of a record, whose gains are kept apart
ROWS_MIN = 100  # rows
STEPS = 4  # of the fit of a stick, from the weights of the line through OP


@dataclass(frozen=True, eq=False)
class Gains:
    """The gains of a record at one delay.

    k : delay [rows]; sizes : (m,) ``Size`` of each column
    score : (m, 2) of a play and of a stick with a jump [nats];  sections : (m, 2, SECTIONS) log-likelihood of tenths
    shape : (m, 2, 3) J / S, law and start of the best stem, as ``Stems.stem`` takes it
    rivals : score and (SECTIONS,) log-likelihoods of each, by name
    answer : static gain of PV's answer to OP
    """

    k: int
    sizes: Indices
    score: Values
    sections: Values
    shape: Values
    rivals: dict[str, tuple[float, Values]]
    answer: float


class Tried(NamedTuple):
    """Stems of several sizes, jumps over S, laws and starts, (c,) each, as inputs (n, c) of the rows."""

    S: Values
    jumps: Values
    laws: Values
    starts: Values
    inputs: Values


@dataclass(eq=False)
class Stems:
    """A record whose stems can be weighed at any size.

    rows : Rows;  ks : the delays [rows];  order, tail : of the autoregression
    base : what stands beside an input, (n, p); at its end ``moves`` moves of OP
    """

    rows: Rows
    ks: tuple[int, ...]
    order: tuple[int, int]
    tail: float
    weights: Values
    base: Values
    delays: tuple[int, ...]
    moves: int = 0
    _gains: dict[int, Gains] = field(default_factory=dict)
    _inputs_of: dict[tuple[Size, ...], Tried] = field(default_factory=dict)

    def size_range(self) -> range:
        """The coarse sizes of this record, as ``Size``."""
        step = FINER // COARSE
        low, high = (COARSE * math.log10(share * self.rows.travel) for share in (SMALLEST, LARGEST))
        return range(step * math.ceil(low), step * math.floor(high) + 1, step)

    @cached_property
    def beside_moves(self) -> "Stems":
        """The same with OP's last moves beside every stick and rival."""
        u = self.rows.input(self.rows.op)
        last = past(np.diff(u, prepend=u[0]), 1, MOVES)[self.rows.used]
        return replace(self, base=np.concatenate([self.base, last], axis=1), moves=MOVES, _gains={})

    def gains(self, k: int) -> Gains:
        """The gains at delay k over all coarse sizes; kept."""
        if k not in self._gains:
            self._gains[k] = self.weighed(k, list(self.size_range()))
        return self._gains[k]

    def weighed(self, k: int, sizes: Sequence[Size]) -> Gains:
        """The gains of sticks of these sizes at delay k [rows]."""
        b, y, rows = self.order[1], self._kept(self.rows.y), self.rows
        rivals = self._rivals(k)
        S, jumps, laws, starts, stems = self._tried(tuple(sizes))
        first = self._screened(stems, k)
        kept = np.array([
            (lanes := np.flatnonzero((size == S) & ((jumps > 0.0) == jumping)))[np.argmax(first[lanes])]
            for size in dict.fromkeys(S.tolist()) for jumping in (False, True)
        ])  # fmt: skip
        inputs = self._inputs(stems[:, kept], k, b)
        X = np.concatenate([np.broadcast_to(self.base, (len(kept), *self.base.shape)), inputs], axis=2)
        fitted = lines(X, y, self.tail, rows.floor, STEPS, self.weights)
        cost = 0.5 * math.log(len(y)) * X.shape[2]
        plain = rivals["OP"][2]
        own = 1.0 - float(np.sum(plain[2 : 2 + self.order[0]]))
        return Gains(
            k, np.array(sizes), (fitted.total - cost).reshape(-1, 2), _tenths(fitted.each).reshape(-1, 2, SECTIONS),
            np.column_stack([jumps, laws, starts])[kept].reshape(-1, 2, 3),
            {name: (score, _tenths(each[None])[0]) for name, (score, each, _) in rivals.items()},
            float(np.sum(plain[-b:])) / (own if abs(own) > 1e-3 else math.copysign(1e-3, own)),
        )  # fmt: skip

    def _tried(self, sizes: tuple[Size, ...]) -> Tried:
        """The stems of these sizes, which are the same at all delays; kept."""
        if sizes not in self._inputs_of:
            rows = self.rows
            tried = [
                (10.0 ** (i / FINER), j, law, at)
                for i in sizes
                for j, law in JUMPS
                for at in (STARTS if 10.0 ** (i / FINER) >= 0.5 * rows.travel else (0.0,))
            ]
            S, jumps, laws, starts = (np.array(column) for column in zip(*tried, strict=True))
            stems = rows.input(_stems(rows.op, S, jumps, laws, starts))
            self._inputs_of[sizes] = Tried(S, jumps, laws, starts, stems)
        return self._inputs_of[sizes]

    @property
    def count(self) -> int:
        """Rows that count."""
        return len(self.base)

    def stem(self, S: float, shape: Values) -> Values:
        """The stem of size S and of shape (J / S, law, start) at full rate, (m,) [unit of OP]."""
        return _stems(self.rows.op, *np.array([[S, *shape]]).T)[:, 0]

    def reversals(self, S: float, shape: Values) -> int:
        """How often such a stem turns round."""
        moves = np.sign(np.diff(self.stem(S, shape)))
        moves = moves[moves != 0.0]
        return int(np.sum(moves[1:] != moves[:-1]))

    def _kept(self, x: Values) -> Values:
        return np.asarray(x[LATEST_ROWS:][self.rows.used])

    def _inputs(self, w: Values, k: int, b: int) -> Values:
        """Inputs (n, c) or (n,) of k to k + b - 1 rows ago: (c, rows, b)."""
        lagged = past(w, k, b)[self.rows.used]
        return np.ascontiguousarray(np.moveaxis(lagged, 2, 0)) if lagged.ndim == 3 else lagged[None]

    def _screened(self, inputs: Values, k: int) -> Values:
        """Log-likelihood of every input (n, c) but for a constant, at the weights of the line through OP, (c,)."""
        from stickslip.detect.likelihood.kernels import explained_by

        root, y = np.sqrt(self.weights), self._kept(self.rows.y)
        q, _ = np.linalg.qr(self.base * root[:, None])
        target = y * root
        target = target - q @ (q.T @ target)
        explained = np.empty((inputs.shape[1], self.order[1]))
        at = np.flatnonzero(self.rows.used) + LATEST_ROWS
        explained_by(np.ascontiguousarray(inputs.T), at, k, root, np.ascontiguousarray(q.T), target, explained)
        return np.asarray(-np.log(np.maximum(target @ target - explained[:, 0], 1e-300)))

    def _rivals(self, k: int) -> dict[str, Fitted]:
        """Score, log-likelihood of every row and coefficients of each rival at delay k."""
        rows, (_, b), y = self.rows, self.order, self._kept(self.rows.y)
        u = rows.input(rows.op)
        up = _ways(u)
        risen = past(_ways(rows.y), 1, 1)[rows.used]
        low, high = np.percentile(u, [100.0 / 3.0, 200.0 / 3.0])
        plain = self._inputs(u, k, b)[0]
        inputs: dict[str, list[Values]] = {
            "OP": [plain],
            "a bent characteristic": [plain, *(self._inputs(np.maximum(u - at, 0.0), k, b)[0] for at in (low, high))],
            "another answer each way": [
                *(self._inputs(np.column_stack([u * up, u * (1.0 - up)]), k, b)), past(up, k, 1)[rows.used]
            ],
            "a sensor with hysteresis": [plain, self.base[:, 2:4] * risen, risen],
        }  # fmt: skip
        found = dict(self._at_any_delay)
        for name, parts in inputs.items():
            found[name] = self._rival(np.concatenate([self.base, *parts], axis=1)[None], y, (k,))
        return found

    @cached_property
    def _at_any_delay(self) -> dict[str, Fitted]:
        """The rivals that are the same whatever delay is assumed."""
        b, y, u = self.order[1], self._kept(self.rows.y), self.rows.input(self.rows.op)
        late = np.stack([np.concatenate([self.base, self._inputs(u, d, b)[0]], axis=1) for d in self.delays])
        score, each, line = self._rival(late, y, self.delays)
        return {
            "nothing": self._rival(self.base[None], y),
            LATE: (score - 0.5 * math.log(len(y)), each, line),  # the delay was chosen
        }

    def _rival(self, X: Values, y: Values, ks: Sequence[int] = ()) -> Fitted:
        """The best of the lines X (c, n, p), through OP from ``ks`` rows ago on; moves are free that follow from it."""
        fitted = lines(X, y, self.tail, self.rows.floor)
        free = np.array([X.shape[2] - _repeated(self.moves, k, self.order[1]) for k in ks] or [X.shape[2]])
        scores = fitted.total - 0.5 * math.log(len(y)) * free
        i = int(np.argmax(scores))
        return float(scores[i]), fitted.each[i], fitted.b[i]


def stems_of(op: Values, pv: Values) -> Stems | None:
    """Return a record ready for weighing stems, or None if too little of it moves or is left.

    ``op``, ``pv`` (m,) stand on an even grid.

    >>> t = np.arange(2000.0)
    >>> rng = np.random.default_rng(1)
    >>> u = 5 * np.sin(t / 25) + np.sin(t / 80)
    >>> y = np.concatenate([[0.0], stick(u, 2.0)[:-1]]) + 0.1 * rng.normal(size=2000)
    >>> found = stems_of(u, y).gains(1)
    >>> round(float(10 ** (found.sizes[found.score[:, 0].argmax()] / FINER)), 1)
    1.8
    """
    rows = rows_of(op, pv)
    if rows is None or int(np.sum(rows.used)) < ROWS_MIN:
        return None
    y = rows.y[LATEST_ROWS:][rows.used]
    u = rows.input(rows.op)
    time = np.linspace(-1.0, 1.0, len(rows.y))[LATEST_ROWS:][rows.used]
    delays = tuple(d for d in DELAYS if d <= NEAR or 2 * d * rows.q <= rows.between)
    logs = 0.5 * math.log(len(y))
    score = np.empty((len(ORDERS), len(delays)))
    bases = []
    for i, (a, b) in enumerate(ORDERS):
        bases.append(np.column_stack([np.ones(len(y)), time, past(rows.y, 1, a)[rows.used]]))
        X = np.stack([np.concatenate([bases[i], past(u, d, b)[rows.used]], axis=1) for d in delays])
        score[i] = lines(X, y, TAILS[0], rows.floor, 4).total - logs * X.shape[2]
    near = score[:, :NEAR]
    best = score if score.max() >= near.max() + SURE_NATS else near
    i, at = (int(n) for n in np.unravel_index(int(np.argmax(best)), best.shape))
    (a, b), d = ORDERS[i], delays[at]
    X = np.concatenate([bases[i], past(u, d, b)[rows.used]], axis=1)[None]
    fits = {nu: lines(X, y, nu, rows.floor) for nu in TAILS}
    tail = max(TAILS, key=lambda nu: float(fits[nu].total[0]))
    ks = (1, 2, 3) if d <= NEAR else (1, 2, 3, round(0.5 * d), round(0.75 * d), d)
    return Stems(rows, ks, (a, b), tail, fits[tail].w[0], bases[i], delays)


def _repeated(moves: int, k: int, b: int) -> int:
    """How many of the last moves of OP follow from b values of it from k rows ago on.

    >>> _repeated(4, 1, 3), _repeated(4, 2, 3), _repeated(4, 2, 8), _repeated(4, 6, 3), _repeated(0, 1, 3)
    (2, 2, 3, 0, 0)
    """
    return max(min(moves, k + b - 2) - k + 1, 0)


def _stems(u: Values, S: Values, jumps: Values, laws: Values, starts: Values) -> Values:
    """Stems (n, m) of OP u (n,) for S, J / S, law and start (m,)."""
    found = np.empty((len(u), len(S)))
    kano = laws == KANO
    if kano.any():
        found[:, kano] = stick(u, S[kano], (jumps * S)[kano], starts[kano])
    for start in STARTS:
        these = (laws == HE) & (starts == start)
        if these.any():
            found[:, these] = he(u, S[these], (jumps * S)[these], start).T
    return found


def _tenths(each: Values) -> Values:
    """Sums of (c, n) over tenths of the rows, (c, SECTIONS)."""
    return np.stack([part.sum(axis=1) for part in np.array_split(each, SECTIONS, axis=1)], axis=1)


def _ways(x: Values) -> Values:
    """1 where x (n,) rises or rose last, else 0, (n,)."""
    step = np.sign(np.concatenate([[1.0], np.diff(x)]))
    last = np.maximum.accumulate(np.where(step != 0.0, np.arange(len(x)), 0))
    return np.asarray((step[last] > 0.0).astype(float))
