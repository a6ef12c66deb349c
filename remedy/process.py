"""How likely a record is with a sticky stem and a process behind it, and which gain and noise it has then.

    PV = K x + c + d t + v,   v an autoregression,   x = G w,   w the stem, as a bank of stems sees it (``bank``)
    G = exp(-theta s) / (tau s + 1) / (tau_2 s + 1),   or exp(-theta s) / s / (tau_2 s + 1)    OP and stem are held

The likelihood of ``stickslip.detect.likelihood`` leaves the answer of PV to the stem free; here it is that of a
process, so that lags and dead time are known and may be simulated.  K, c, d and the autoregression follow by least
squares in turns (Cochrane and Orcutt 1949, J. Am. Stat. Assoc. 44:32).  v is what is left: load and noise as they came
to PV.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from stickslip.detect.likelihood.rows import rows_of
from stickslip.logs.arrays import Values
from stickslip.remedy.left import SHARE, Left, free_of_line, left_of, past, size, wandering, whitened

__all__ = [
    "DRAWS", "Day", "Found", "Loop", "Predicted", "beside", "day_of", "fresh", "predicted", "profiled", "settled",
    "start_noise",
]  # fmt: skip

MOST, FEW = 7_200, 2_400  # rows that a likelihood looks at, and a search for where to begin
HEAVY = 3.0  # degrees of freedom of breakaways: some are far from the others
DRAWS = range(1, 9)  # of random numbers, beside 0 of the search
QUIET = 0.002  # of PV's spread: noise below it is taken for none


@dataclass(frozen=True)
class Loop:
    """Valve and process of one loop.

    follows : whether a stem that moves goes on with OP, or sticks again at every scan;  S, J : [unit of OP]
    r : by which breakaways and places of rest vary from slip to slip, over (S + J)/2 [-]
    integrating : kind;  K : gain [unit of PV per unit of OP, and per s where it integrates]
    tau, tau_2, theta : lags and dead time [s]; tau has no meaning where it integrates
    """

    follows: bool
    S: float
    J: float
    integrating: bool
    K: float
    tau: float
    tau_2: float
    theta: float
    r: float = 0.05


@dataclass(frozen=True, eq=False)
class Day:
    """One record on an even grid: t, op, pv (n,), SP or None; ``q`` samples make a row; ``between`` turns [samples].

    Rows are samples as far as they may be: within a mean of several the controller answers, so that OP tells PV.
    """

    t: Values
    dt: float
    op: Values
    pv: Values
    sp: Values | None
    q: int
    between: float

    @cached_property
    def coarse(self) -> Day:
        """The same day with fewer rows."""
        return replace(self, q=max(self.q, math.ceil(len(self.op) / FEW)))

    @cached_property
    def rows(self) -> Values:
        """PV as rows, (rows,)."""
        n = len(self.pv) // self.q
        return np.asarray(self.pv[: n * self.q].reshape(n, self.q).mean(axis=1))

    @cached_property
    def free(self) -> tuple[Values, tuple[float, float]]:
        """The rows of PV without their line, and that line."""
        return free_of_line(self.rows)

    @cached_property
    def memories(self) -> tuple[Values, Values]:
        """The autoregression of PV as if it wandered: for a process that settles, and for one that integrates."""
        return wandering(self.rows, 1), wandering(self.rows, 2)


@dataclass(frozen=True, eq=False)
class Found:
    """A loop, the noise of each day, and their negative log-likelihood [nats]."""

    loop: Loop
    noises: tuple[Left, ...]
    nll: float


@dataclass(frozen=True, eq=False)
class Predicted:
    """What a loop says of the days: the likelihood of ``each`` row [nats]; of each day a stem and its answer."""

    each: Values
    shown: tuple[Values, ...]

    @property
    def nll(self) -> float:
        """The negative log-likelihood of all rows [nats]."""
        return -float(self.each.sum())


def day_of(t: Values, op: Values, pv: Values, sp: Values | None) -> Day | None:
    """A record (n,) on an even grid made ready; None where OP or PV stands."""
    rows = rows_of(op, pv)
    if rows is None:
        return None
    return Day(t, float(t[1] - t[0]), op, _noisy(pv), sp, math.ceil(len(op) / MOST), rows.between)


def _noisy(pv: Values) -> Values:
    """PV (n,) of a record without noise, as simulations write them, with a little; any other as it is.

    An autoregression tells the next row of a smooth PV to the last digit, and any loop beside the true one is then
    unlikely beyond all bounds.
    """
    smooth = float(np.median(np.abs(np.diff(pv, 3)))) / 3.0  # of white noise of spread 1 this is 1.005
    floor = QUIET * float(np.std(pv))
    return pv if smooth > floor else pv + floor * np.random.default_rng(len(pv)).normal(size=len(pv))


@lru_cache(maxsize=8)
def _random(samples: int, stems: int) -> Values:
    """Deviates (2, samples, stems): of breakaways, one stem in each ``stems``-th part of Student's t; normal ones."""
    from scipy.special import stdtrit

    rng = np.random.default_rng(samples)
    found = rng.normal(size=(2, samples + 64, stems))
    part = rng.permuted(np.tile(np.arange(stems), (samples + 64, 1)), axis=1)
    found[0] = stdtrit(HEAVY, (part + rng.random(part.shape)) / stems)
    return found


def predicted(days: Sequence[Day], one: Loop, noises: Sequence[Left], draw: int = 0) -> Predicted:
    """The likelihood of the days with a loop and the noise that each day has; ``draw`` of the bank's random numbers."""
    from stickslip.remedy.bank import STEMS, passed

    each, shown = [np.zeros(len(day.rows)) for day in days], []
    for day, noise, nats in zip(days, noises, each, strict=True):
        y = day.rows
        own = np.zeros((2, len(y) * day.q))
        passed(
            day.op - day.op[0], y, day.q, day.dt, float(one.follows), one.S, one.J, one.r, one.integrating, one.tau,
            one.tau_2, one.theta, one.K, noise.a, noise.c, noise.d, noise.s,
            _random(len(own[0]), STEMS if one.S > 0.0 else 1)[:, draw : draw + len(own[0])], own, nats,
        )  # fmt: skip
        shown.append(own)
    return Predicted(np.concatenate(each), tuple(shown))


def fresh(days: Sequence[Day], found: Found) -> Values:
    """The log-likelihood of each row (rows,) by random numbers that did not serve to find the loop [nats].

    The least of many tries is so by luck too.  Of likelihoods the mean: a bank's has no bias, its logarithm has.
    """
    sums = [np.cumsum(predicted(days, found.loop, found.noises, draw).each) for draw in DRAWS]
    return np.diff(np.logaddexp.reduce(sums), prepend=math.log(len(sums)))


_Answer = tuple[Values, tuple[float, float]]


def _answers(days: Sequence[Day], shown: Sequence[Values]) -> list[_Answer]:
    """The rows of each day's answer without their line, and that line."""
    return [free_of_line(own[1].reshape(-1, day.q).mean(axis=1)) for own, day in zip(shown, days, strict=True)]


def _noises(days: Sequence[Day], answers: Sequence[_Answer], K: float) -> tuple[Left, ...]:
    """What is left of each day behind the gain K."""
    noises = []
    for (x, (c, d)), day in zip(answers, days, strict=True):
        v, line = day.free[0] - K * x, (day.free[1][0] - K * c, day.free[1][1] - K * d)
        noises.append(left_of(v, line, past(v), SHARE))
    return tuple(noises)


def settled(days: Sequence[Day], one: Loop, shown: Sequence[Values], rounds: int = 3) -> tuple[Loop, tuple[Left, ...]]:
    """The loop with the gain that the answers ask for, and its noise.

    K keeps its sign: an answer the wrong way round is the controller's, not the process's.
    """
    answers = _answers(days, shown)
    pasts = [day.memories[one.integrating] for day in days]
    way, K, noises = math.copysign(1.0, one.K), one.K, tuple[Left, ...]()
    for _ in range(rounds):
        top, bottom = 0.0, 1e-300
        for (x, _), day, a in zip(answers, days, pasts, strict=True):
            if np.ptp(x) <= 1e-9:  # a stem that never moves tells no gain
                continue
            xw, yw = whitened(x, a), whitened(day.free[0], a)
            weight = 1.0 / (size(yw - K * xw) + 1e-300)
            top += weight * float(xw @ yw)
            bottom += weight * float(xw @ xw)
        K = way * max(way * top / bottom, 0.0)
        noises = _noises(days, answers, K)
        pasts = [noise.a for noise in noises]
    return replace(one, K=K), noises


def profiled(days: Sequence[Day], one: Loop, noises: Sequence[Left], draw: int = 0) -> Found:
    """The loop with the gain and the noise that its likely path asks for; ``draw`` of the bank's random numbers."""
    found, after = settled(days, one, predicted(days, one, noises, draw).shown)
    return Found(found, after, predicted(days, found, after, draw).nll)


def beside(days: Sequence[Day], one: Loop, noises: Sequence[Left], draw: int = 0) -> Found:
    """The loop as it is, with the noise that its likely path leaves; ``draw`` of the bank's random numbers."""
    after = _noises(days, _answers(days, predicted(days, one, noises, draw).shown), one.K)
    return Found(one, after, predicted(days, one, after, draw).nll)


def start_noise(days: Sequence[Day], integrating: bool = False) -> list[Left]:
    """The noise of each day as if all of PV were noise."""
    return [left_of(*day.free, day.memories[integrating]) for day in days]
