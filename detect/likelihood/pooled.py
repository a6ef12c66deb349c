"""Evidence of one valve from one record or from many: log-likelihoods of days add up, because the valve is the same.

    G(S)    = sum over records of the score of S, where there are several by the mean likelihood of S and the sizes
              beside it, because a stick is not quite the same each day; less the score of that rival which tells all
              records best, less ln(n)/2 for S and as much for J
    G       = max of G(S) over S >= 0.1 of OP's travel [nats];   G_d = G without the best tenth of any record
    against = loss of the likeliest S >= 0.15 of OP's travel against the best rival, with OP's last moves beside both or
              without them, whichever is less [nats]

    unpaid  = the most that any play or stick gains over the best rival at any delay, not paying for its size [nats]
    bends   = the most that a bent characteristic, another answer each way or a sensor with hysteresis gains over a
              straight line and over nothing [nats]
    bent    = the most that these or a stick gain over a straight line [nats]

A valve has dead travel where G >= 10, G_d >= 5, the stem turns at least four times and, of days that tell anything,
no more speak against than for it and no single one is all there is: all that at two of three delays beside each other.
It is shown to have none where every S from 0.15 of OP's travel on loses 10 nats at all delays, no play or stick beats
the best rival at any delay, a straight line predicts PV best, PV answers OP by 10 nats at all, that answer keeps sign
and size over the delays, and OP turns at least four times.  Else the record leaves it open.
So it does with fewer than ten samples between two turns of OP.
Bootstrap tests pass a one-way drift; turns, the tenth and delays do not.  A valve that sticks often makes a bent rival
look good, in place of the stick: of 170 sticky loops (training law, seed 70001) 10 lost every S without the rule on the
straight line, and 3 with it, two of them of S below 0.15 of OP's travel.

Source: ours; the limits are those of a trial on real and simulated loops, kept as they were, but for the straight
line.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.detect.likelihood.stems import COARSE, FINER, LATE, Gains, Stems
from stickslip.logs.arrays import Indices, Values

GAIN_NATS, WITHOUT_BEST_NATS, TURNS, DELAYS = 10.0, 5.0, 4, 2  # to accuse
LOSS_NATS, ANSWERS_NATS, KEEPS = 10.0, 10.0, 3.0  # to clear
ACCUSED_SHARE, EXCLUDED_SHARE = 0.1, 0.15  # of OP's travel: least S that is called, that must be excluded
INTERVAL_NATS = 2.0  # nats below the best that S's interval reaches
FINEST_SAMPLES = 10.0  # samples between two turns of OP, below which sampling makes false gains
SAYS_NATS = 1.0  # nats of a day that tells anything
JUMP_NATS = 5.0  # nats from which on a jump is called


@dataclass(frozen=True)
class Day:
    """One record of the valve: S [unit of OP] and gain [nats] of its own, what it adds to the pool, OP's travel."""

    S: float
    gain: float
    adds: float
    travel: float
    turns: int


@dataclass(frozen=True, eq=False)
class Evidence:
    """The evidence for dead travel from the records of one valve.

    S, low, high : dead travel and what lies within 2 nats of it [unit of OP]; J : the jump, 0 unless it gains
    jump : what the jump gains [nats]; gain, without_best : G and G_d [nats]; turns : of the stem, over all records
    delays : of three beside each other, at which all that holds;  rival : the best one
    excluded : least S [unit of OP] from which on all sizes lose ``loss`` nats at every delay; inf where none does
    loss : [nats];  answers : [nats] by which OP predicts PV, least over the delays;  steady : its size stays
    travel : OP's, median over the records [its unit]
    sizes, curve : (m,) S [unit of OP] and G(S) [nats] at the delay that is shown
    tenths : (10 records,) log-likelihood gained in each tenth of each record [nats]
    turned : turns of OP in all records;  between : samples between two of them, median;  bent, bends, unpaid : [nats]
     days : one a record, in order
    shapes : of the best stem in each record, as ``Stems.stem`` takes it
    """

    S: float
    low: float
    high: float
    J: float
    jump: float
    gain: float
    without_best: float
    turns: int
    delays: int
    rival: str
    excluded: float
    loss: float
    answers: float
    steady: bool
    travel: float
    sizes: Values
    curve: Values
    tenths: Values
    turned: int
    between: float
    bent: float
    bends: float
    unpaid: float
    days: tuple[Day, ...]
    shapes: tuple[Values, ...]

    @property
    def accuses(self) -> bool:
        """Whether the valve has dead travel."""
        return self.delays >= DELAYS and not self.coarse

    @property
    def coarse(self) -> bool:
        """Whether there are too few samples between two turns of OP."""
        return self.between < FINEST_SAMPLES

    @property
    def better(self) -> bool:
        """Whether a play or stick predicts PV better than every rival."""
        return self.gain > 0.0

    @property
    def excludes(self) -> bool:
        """Whether every S from ``EXCLUDED_SHARE`` of OP's travel on is excluded, a line is best and PV answers OP."""
        hidden = self.excluded > EXCLUDED_SHARE * self.travel * 10.0 ** (1.0 / COARSE)  # the next size of the grid
        answered = self.answers >= ANSWERS_NATS and self.steady and self.turned >= TURNS
        return not hidden and answered and self.bent <= 0.0 and not self.coarse

    @property
    def clears(self) -> bool:
        """Whether that clears the valve: no play or stick of any size beats the rivals at any delay, either."""
        return self.excludes and self.unpaid <= 0.0

    @property
    def claim(self) -> float:
        """Least S from which on all are said to be excluded [unit of OP]; smaller ones would not show reliably."""
        return max(self.excluded, EXCLUDED_SHARE * self.travel)

    @property
    def agreeing(self) -> int:
        """Records that speak for this S."""
        return sum(day.adds > SAYS_NATS for day in self.days)


@dataclass(frozen=True)
class _At:
    """The pool at one delay."""

    holds: bool
    gain: float
    without_best: float
    turns: int
    unpaid: float
    size: int
    jumps: bool
    total: Values
    grid: Indices
    at: tuple[int, ...]
    kept: tuple[Gains, ...]
    rival: str
    tenths: Values


def evidence_of(records: Sequence[Stems]) -> Evidence:
    """The evidence of one valve from its records; raises ValueError for none.

    >>> from stickslip.detect.likelihood.stems import stems_of
    >>> from stickslip.detect.stem.stick import stick
    >>> t, rng = np.arange(2000.0), np.random.default_rng(1)
    >>> u = 5 * np.sin(t / 25) + np.sin(t / 80)
    >>> y = np.concatenate([[0.0], stick(u, 2.0)[:-1]]) + 0.1 * rng.normal(size=2000)
    >>> found = evidence_of([stems_of(u, y)])
    >>> round(found.S, 1), found.J, found.accuses, found.clears  # the true S is 2
    (1.8, 0.0, True, False)
    """
    if not records:
        raise ValueError("records is empty; give the stems of at least one record")
    travel = float(np.median([one.rows.travel for one in records]))
    step = FINER // COARSE
    ranges = [one.size_range() for one in records]
    grid = np.arange(min(r[0] for r in ranges), max(r[-1] for r in ranges) + 1, step)
    least = FINER * math.log10(ACCUSED_SHARE * travel)
    count = max(len(one.ks) for one in records)  # 3, and 3 longer ones where OP without a stick likes a delay
    ks = [[one.ks[d] if d < len(one.ks) else one.ks[d - 3] for one in records] for d in range(count)]
    at = [_at([one.gains(k) for one, k in zip(records, each, strict=True)], records, grid, least) for each in ks]
    free = [one.beside_moves for one in records]
    beside = [_at([one.gains(k) for one, k in zip(free, each, strict=True)], free, grid, least) for each in ks]
    near = [_nearer(one, records, each, least) for one, each in zip(at, ks, strict=True)]
    shown = max(range(count), key=lambda d: (near[d].holds, min(near[d].gain, 2.0 * near[d].without_best)))
    best, column = near[shown], int(near[shown].jumps)
    S = 10.0 ** (best.size / FINER)
    shapes = tuple(part.shape[a, column] for part, a in zip(best.kept, best.at, strict=True))
    J = S * float(np.mean([shape[0] for shape in shapes]))
    low, high = _interval(best, at[shown])
    losses = np.stack(
        [np.maximum.accumulate(one.total.max(axis=1)[::-1])[::-1] for one in (*at, *beside)]
    )  # at least that large
    worst = losses.max(axis=0)
    out = np.flatnonzero(worst <= -LOSS_NATS)
    answers = [[gains.answer for gains in one.kept] for one in at[-3:]]
    holds = max(sum(one.holds for one in near[d : d + 3]) for d in range(0, count, 3))
    days = tuple(_day(one, at[shown].kept[i], best, i) for i, one in enumerate(records))
    return Evidence(
        S, low, high, J, float(best.total[:, 1].max() - best.total[:, 0].max()), best.gain, best.without_best,
        best.turns, holds, best.rival,
        10.0 ** (grid[out[0]] / FINER) if len(out) else math.inf, float(-worst[out[0]]) if len(out) else 0.0,
        min(_answers(one.kept) for one in at[-3:]), _steady(answers), travel,
        10.0 ** (grid / FINER), at[shown].total.max(axis=1), best.tenths,
        sum(one.rows.turned for one in records), float(np.median([one.rows.between for one in records])),
        max(_bent(one)[0] for one in at), max(_bent(one)[1] for one in at),
        max(one.unpaid for one in (*at, *beside)), days, shapes,
    )  # fmt: skip


def _summed(parts: Sequence[Gains], grid: Indices, freedom: int, rival: str, rows: int) -> tuple[Values, list[Indices]]:
    """G at every size of the grid, (m, 2), and which size of each record makes it up, [(m, 2)] columns."""
    total = np.zeros((len(grid), 2)) - _paid(rows)
    chosen = []
    for part in parts:
        near = np.abs(np.clip(grid, part.sizes[0], part.sizes[-1])[:, None] - part.sizes[None, :]) <= freedom
        masked = np.where(near[:, :, None], part.score[None, :, :] - part.rivals[rival][0], -np.inf)
        top = masked.max(axis=1)
        alike = np.exp(masked - top[:, None, :]).sum(axis=1) / near.sum(axis=1)[:, None]
        total += top + np.log(alike)  # the mean likelihood of the sizes beside each other
        chosen.append(masked.argmax(axis=1))
    return total, chosen


def _paid(rows: int) -> Values:
    """What S, and S and J, cost [nats], (2,)."""
    return 0.5 * math.log(rows) * np.array([1.0, 2.0])


def _at(kept: Sequence[Gains], records: Sequence[Stems], grid: Indices, least: float) -> _At:
    """The pool at one delay of each record."""
    rival = max(kept[0].rivals, key=lambda name: sum(part.rivals[name][0] for part in kept))
    rows = sum(one.count for one in records)
    total, chosen = _summed(kept, grid, FINER // COARSE if len(kept) > 1 else 0, rival, rows)
    allowed = np.where((grid >= least)[:, None], total, -np.inf)
    i, j = (int(n) for n in np.unravel_index(int(np.argmax(allowed)), allowed.shape))
    if j and total[i, 1] < allowed[:, 0].max() + JUMP_NATS:  # a jump is called only where it gains
        i, j = int(np.argmax(allowed[:, 0])), 0
    at = tuple(int(one[i, j]) for one in chosen)
    sections = np.concatenate([part.sections[a, j] - part.rivals[rival][1] for part, a in zip(kept, at, strict=True)])
    gain = float(total[i, j])
    without = gain - max(float(sections.max()), 0.0)
    turned = 0
    for one, part, a in zip(records, kept, at, strict=True):
        S = 10.0 ** (part.sizes[a] / FINER)
        turned += one.reversals(S, part.shape[a, j])
    adds = [part.score[a, j] - part.rivals[rival][0] for part, a in zip(kept, at, strict=True)]
    agree = sum(x > SAYS_NATS for x in adds) >= sum(x < -SAYS_NATS for x in adds) and (
        len(adds) == 1 or gain > max(adds)
    )
    holds = gain >= GAIN_NATS and without >= WITHOUT_BEST_NATS and turned >= TURNS and agree
    unpaid = float((total + _paid(rows)).max())
    return _At(
        holds, gain, without, turned, unpaid, int(grid[i]), bool(j), total, grid, at, tuple(kept), rival, sections
    )


def _nearer(coarse: _At, records: Sequence[Stems], ks: Sequence[int], least: float) -> _At:
    """The pool at one delay on finer sizes about its best; as it is where nothing is gained."""
    if coarse.gain < 0.0:
        return coarse
    step = FINER // COARSE
    fine = np.arange(coarse.size - 3 * step, coarse.size + 3 * step + 1)  # beside those that can be best
    parts = [one.weighed(k, fine.tolist()) for one, k in zip(records, ks, strict=True)]
    inside = (fine >= coarse.size - step) & (fine <= coarse.size + step)
    return _at(parts, records, fine[inside], least)


def _interval(best: _At, coarse: _At) -> tuple[float, float]:
    """Where G lies within ``INTERVAL_NATS`` of its best, on the fine sizes and, beyond them, on the coarse ones."""
    sizes = np.concatenate([best.grid, coarse.grid])
    values = np.concatenate([one.total[:, int(best.jumps)] for one in (best, coarse)])
    inside = sizes[values >= best.gain - INTERVAL_NATS]
    return 10.0 ** ((inside.min() - 1) / FINER), 10.0 ** ((inside.max() + 1) / FINER)


def _day(one: Stems, own: Gains, best: _At, i: int) -> Day:
    """What a record says by itself, and what it adds to the pool."""
    column = int(best.jumps)
    cost = 0.5 * math.log(one.count) * (1 + column)
    gains = own.score[:, column] - own.rivals[best.rival][0] - cost
    peak = int(np.argmax(gains))
    S = 10.0 ** (own.sizes[peak] / FINER)
    adds = best.kept[i].score[best.at[i], column] - best.kept[i].rivals[best.rival][0]
    return Day(S, float(gains[peak]), float(adds), one.rows.travel, one.reversals(S, own.shape[peak, column]))


def _answers(kept: Sequence[Gains]) -> float:
    """By how many nats OP predicts PV better than nothing."""
    return float(sum(part.rivals["OP"][0] - part.rivals["nothing"][0] for part in kept))


def _bent(one: _At) -> tuple[float, float]:
    """``bent`` and ``bends`` at one delay."""
    score = {name: sum(part.rivals[name][0] for part in one.kept) for name in one.kept[0].rivals}
    line, stick = max(score["OP"], score[LATE]), float(one.total.max()) + score[one.rival] - score["OP"]
    bends = max(score[name] for name in score if name not in ("OP", LATE, "nothing"))
    return max(stick, bends - line), bends - max(line, score["nothing"])


def _steady(answers: Sequence[Sequence[float]]) -> bool:
    """Whether the static answer of PV to OP keeps sign and size over the delays in most records."""
    keeps = 0
    for each in zip(*answers, strict=True):
        size = np.abs(each)
        keeps += bool(abs(np.sum(np.sign(each))) == len(each) and size.max() <= KEEPS * size.min())
    return 2 * keeps > len(answers[0])
