"""Evidence of one valve from one record or from many: log-likelihoods of days add up, because the valve is the same.

    G(S)    = sum over records of the score of S, with one grid step of freedom for each where there are several,
              less the score of that rival which tells all records best, less ln(n)/2 for S and as much for J
    G       = max of G(S) over S >= 0.1 of OP's travel [nats];   G_d = G without its best tenth of all records
    against = loss of the likeliest S >= 0.15 of OP's travel against the best rival [nats]

A valve has dead travel where G >= 10, G_d >= 5, the stem turns at least four times and, of days that tell anything,
no more speak against than for it: all that at two of three delays.  It is shown to have none where every S from
0.15 of OP's travel on loses 10 nats at all three, PV answers OP by 10 nats at all, and that answer keeps sign and size
over the delays.  Else the record leaves it open.  Bootstrap tests pass a one-way drift; turns, the tenth and delays
do not.

Source: ours; the limits are those of a trial on real and simulated loops, kept as they were.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from detect.likelihood.stems import COARSE, FINER, SECTIONS, Gains, Stems

__all__ = ["Day", "Evidence", "evidence_of"]

Values = npt.NDArray[np.float64]
GAIN, WITHOUT_BEST, TURNS, DELAYS = 10.0, 5.0, 4, 2  # to accuse
LOSS, ANSWERS, KEEPS = 10.0, 10.0, 3.0  # to clear
ACCUSED, EXCLUDED = 0.1, 0.15  # of OP's travel: least S that is called, that must be excluded
WITHIN = 2.0  # nats below the best that S's interval reaches
SAYS = 1.0  # nats of a day that tells anything
JUMPS = 3.0  # nats from which on a jump is told


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
    """What the records of one valve say of dead travel.

    S, low, high : dead travel and what lies within 2 nats of it [unit of OP]; J : the jump, 0 unless it gains
    jump : what the jump gains [nats]; gain, without_best : G and G_d [nats]; turns : of the stem, over all records
    delays : of three, at which all that holds;  rival : the best one
    excluded : least S [unit of OP] from which on all sizes lose ``loss`` nats at every delay; inf where none does
    loss : [nats];  answers : by how many nats OP tells PV, least over the delays;  steady : that answer keeps its size
    travel : OP's, median over the records [its unit]
    sizes, curve : (m,) S [unit of OP] and G(S) [nats] at the delay that is shown
    days : one a record, in order;  k, start : the delay shown, and the start of the best stem in each record
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
    days: tuple[Day, ...]
    k: int
    start: tuple[float, ...]

    @property
    def accuses(self) -> bool:
        """Whether the valve has dead travel."""
        return self.delays >= DELAYS

    @property
    def better(self) -> bool:
        """Whether any play or stick tells PV better than every rival."""
        return self.gain > 0.0

    @property
    def clears(self) -> bool:
        """Whether every S from ``EXCLUDED`` of OP's travel on is excluded, and PV answers OP."""
        return (
            not self.better and self.excluded <= EXCLUDED * self.travel * 10.0 ** (1.0 / COARSE)
            and self.answers >= ANSWERS and self.steady
        )  # fmt: skip

    @property
    def agreeing(self) -> int:
        """Records that speak for this S."""
        return sum(day.adds > SAYS for day in self.days)


@dataclass(frozen=True)
class _At:
    """The pool at one delay."""

    holds: bool
    gain: float
    without_best: float
    turns: int
    size: int
    jumps: bool
    total: Values
    grid: npt.NDArray[np.intp]
    at: tuple[int, ...]
    kept: tuple[Gains, ...]
    rival: str


def evidence_of(records: Sequence[Stems]) -> Evidence:
    """The evidence of one valve from its records; raises ValueError for none.

    >>> from detect.likelihood.stems import stems_of
    >>> from detect.prepare.stick import stick
    >>> t, rng = np.arange(2000.0), np.random.default_rng(1)
    >>> u = 5 * np.sin(t / 25) + np.sin(t / 80)
    >>> y = np.concatenate([[0.0], stick(u, 2.0)[:-1]]) + 0.1 * rng.normal(size=2000)
    >>> found = evidence_of([stems_of(u, y)])
    >>> round(found.S, 1), found.J, found.accuses, found.clears
    (2.0, 0.0, True, False)
    """
    if not records:
        raise ValueError("records is empty; give the stems of at least one record")
    travel = float(np.median([one.rows.travel for one in records]))
    step = FINER // COARSE
    ranges = [one.size_range() for one in records]
    grid = np.arange(min(r[0] for r in ranges), max(r[-1] for r in ranges) + 1, step)
    least = _size(ACCUSED * travel)
    at = [_at([one.gains(one.ks[d]) for one in records], records, grid, least) for d in range(3)]
    shown = max(range(3), key=lambda d: (at[d].holds, min(at[d].gain, 2.0 * at[d].without_best)))
    best = at[shown]
    fine = np.arange(best.size - 2 * step, best.size + 2 * step + 1)
    parts = [one.weighed(one.ks[shown], fine.tolist()) for one in records]
    total, _ = _summed(parts, fine, step if len(parts) > 1 else 0, best.rival, sum(one.count for one in records))
    column = total[:, int(best.jumps)]
    peak = int(np.argmax(column))
    S = 10.0 ** (fine[peak] / FINER)
    J = S * float(np.mean([part.jump[peak] for part in parts])) if best.jumps else 0.0
    low, high = _interval(fine, column, best)
    losses = np.stack([np.maximum.accumulate(one.total.max(axis=1)[::-1])[::-1] for one in at])  # at least that large
    worst = losses.max(axis=0)
    out = np.flatnonzero(worst <= -LOSS)
    answers = [[gains.answer for gains in one.kept] for one in at]
    days = tuple(_day(one, best.kept[i], best, i) for i, one in enumerate(records))
    return Evidence(
        S, low, high, J, float(best.total[:, 1].max() - best.total[:, 0].max()), best.gain, best.without_best,
        best.turns, sum(one.holds for one in at), best.rival,
        10.0 ** (grid[out[0]] / FINER) if len(out) else math.inf, float(-worst[out[0]]) if len(out) else 0.0,
        min(_answers(one.kept) for one in at), _steady(answers), travel,
        10.0 ** (grid / FINER), best.total.max(axis=1), days, best.kept[0].k,
        tuple(part.start[peak, int(best.jumps)] for part in parts),
    )  # fmt: skip


def _size(S: float) -> float:
    return FINER * math.log10(S)


def _summed(
    parts: Sequence[Gains], grid: npt.NDArray[np.intp], freedom: int, rival: str, rows: int
) -> tuple[Values, list[npt.NDArray[np.intp]]]:
    """G at every size of the grid, (m, 2), and which size of each record makes it up, [(m, 2)] columns."""
    total = np.zeros((len(grid), 2)) - 0.5 * math.log(rows) * np.array([1.0, 2.0])
    chosen = []
    for part in parts:
        near = np.abs(np.clip(grid, part.sizes[0], part.sizes[-1])[:, None] - part.sizes[None, :]) <= freedom
        masked = np.where(near[:, :, None], part.score[None, :, :] - part.rivals[rival][0], -np.inf)
        total += masked.max(axis=1)
        chosen.append(masked.argmax(axis=1))
    return total, chosen


def _at(kept: Sequence[Gains], records: Sequence[Stems], grid: npt.NDArray[np.intp], least: float) -> _At:
    """The pool at one delay of each record."""
    rival = max(kept[0].rivals, key=lambda name: sum(part.rivals[name][0] for part in kept))
    total, chosen = _summed(kept, grid, FINER // COARSE if len(kept) > 1 else 0, rival, sum(one.count for one in records))
    allowed = np.where((grid >= least)[:, None], total, -np.inf)
    i, j = (int(n) for n in np.unravel_index(int(np.argmax(allowed)), allowed.shape))
    if j and total[i, 1] < allowed[:, 0].max() + JUMPS:  # a jump is told only where it gains
        i, j = int(np.argmax(allowed[:, 0])), 0
    at = tuple(int(one[i, j]) for one in chosen)
    sections = np.concatenate([part.sections[a, j] - part.rivals[rival][1] for part, a in zip(kept, at, strict=True)])
    gain = float(total[i, j])
    without = gain - float(np.sum(np.maximum(np.sort(sections)[-len(kept) :], 0.0)))
    turned = 0
    for one, part, a in zip(records, kept, at, strict=True):
        S = 10.0 ** (part.sizes[a] / FINER)
        turned += one.reversals(S, S * part.jump[a] * j, float(part.start[a, j]))
    adds = [part.score[a, j] - part.rivals[rival][0] for part, a in zip(kept, at, strict=True)]
    agree = sum(x > SAYS for x in adds) >= sum(x < -SAYS for x in adds)
    holds = gain >= GAIN and without >= WITHOUT_BEST and turned >= TURNS and agree
    return _At(holds, gain, without, turned, int(grid[i]), bool(j), total, grid, at, tuple(kept), rival)


def _interval(fine: npt.NDArray[np.intp], column: Values, best: _At) -> tuple[float, float]:
    """Where G lies within ``WITHIN`` of its best, on the fine grid and, beyond it, on the coarse one."""
    top = float(column.max())
    sizes = np.concatenate([fine, best.grid])
    values = np.concatenate([column, best.total[:, int(best.jumps)]])
    inside = sizes[values >= top - WITHIN]
    return 10.0 ** ((inside.min() - 1) / FINER), 10.0 ** ((inside.max() + 1) / FINER)


def _day(one: Stems, own: Gains, best: _At, i: int) -> Day:
    column = own.score[:, int(best.jumps)] - own.rivals[best.rival][0] - 0.5 * math.log(one.count) * (1 + best.jumps)
    peak = int(np.argmax(column))
    S = 10.0 ** (own.sizes[peak] / FINER)
    jump = S * float(own.jump[peak]) * best.jumps
    turned = one.reversals(S, jump, float(own.start[peak, int(best.jumps)]))
    return Day(S, float(column[peak]), float(column[best.at[i]]), one.rows.travel, turned)


def _answers(kept: Sequence[Gains]) -> float:
    """By how many nats OP tells PV better than nothing."""
    return float(sum(part.rivals["OP"][0] - part.rivals["nothing"][0] for part in kept))


def _steady(answers: Sequence[Sequence[float]]) -> bool:
    """Whether the static answer of PV to OP keeps sign and size over the delays in most records."""
    keeps = 0
    for each in zip(*answers, strict=True):
        size = np.abs(each)
        keeps += bool(abs(np.sum(np.sign(each))) == len(each) and size.max() <= KEEPS * size.min())
    return 2 * keeps > len(answers[0])
