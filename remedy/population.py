"""A population of loops about equally likely, by differential evolution.

    ahead_i = at_i + g (at_a - at_b) + a little,   g = 2.38 / sqrt(2 d), at times 1
    taken with min(1, exp((nll_i - nll_ahead) / T))

d values are free; gain and noise follow each loop.  T = ``TEMPER`` > 1 makes the population wider than the likelihood
says, because no real valve, load or process is the model's; it was set on loops that serve nothing else.  The
likelihood of a bank varies with its random numbers.  They are drawn anew at each step, and a loop that stays is weighed
again, or one that was weighed by luck would stay for ever; T is at least the spread of that.
Source: C. J. F. ter Braak, Stat. Comput. 16 (2006) 239-249.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.remedy.process import Day, Found, Loop, profiled
from stickslip.remedy.search import at_coordinates, coordinates, half_wave, share_of_lags

__all__ = ["population_of"]

TEMPER = 6.0
WALKERS, TURNS, KEPT = 14, 24, 24
FAR = 6.0  # temperatures behind the best, at which a walker starts anew while the population forms
DRAWS = 40  # of random numbers for the bank
LITTLE = (0.05, 0.1, 0.1, 0.02, 0.03, 0.1)  # of each value


def population_of(days: Sequence[Day], starts: Sequence[Found], seed: int = 0) -> tuple[Found, tuple[Loop, ...]]:
    """The loop in the middle of a population that begins at ``starts``, and ``KEPT`` of its loops, that one first."""
    rng, time, dt = np.random.default_rng(seed), half_wave(days), days[0].dt
    starts, luck = _of_a_kind(days, starts)
    walkers = [starts[i % len(starts)] for i in range(WALKERS)]
    temper = max(TEMPER, float(np.std(luck)))
    kept: list[Found] = []
    for turn in range(TURNS):
        forming, least = turn < TURNS // 2, min(one.nll for one in walkers)
        for i in range(WALKERS):
            now, draw = walkers[i], int(rng.integers(1, DRAWS))
            a, b, c = (walkers[int(j)] for j in rng.choice(WALKERS, 3, replace=False))
            if forming and now.nll > least + FAR * temper and a.nll < now.nll:
                now = a
            ahead = _ahead(now, b, c, turn, rng, time)
            if turn % 2:
                now = profiled(days, now.loop, now.noises, draw)
            walkers[i] = now
            one = at_coordinates(now.loop, ahead, time, dt)
            if one is not None:
                found = profiled(days, one, now.noises, draw)
                if math.log(rng.random()) < (now.nll - found.nll) / temper:
                    walkers[i] = found
        if not forming:
            kept += walkers
    return _middle(kept, time)


def _of_a_kind(days: Sequence[Day], starts: Sequence[Found]) -> tuple[list[Found], list[float]]:
    """The starts of the likelier kind of process, by the best of each kind, and its nll (draws,) by other draws.

    A process that settles has one value more than one that integrates, and pays ln(rows)/2 for it, as tempered nats.
    """
    pays = 0.5 * TEMPER * math.log(sum(len(day.rows) for day in days))
    firsts = {one.loop.integrating: one for one in reversed(starts)}
    luck = {k: [profiled(days, one.loop, one.noises, draw).nll for draw in range(1, 7)] for k, one in firsts.items()}
    kind = min(luck, key=lambda each: float(np.mean(luck[each])) + (0.0 if each else pays))
    least = firsts[kind].nll + FAR * TEMPER
    return [one for one in starts if one.loop.integrating == kind and one.nll <= least], luck[kind]


def _ahead(now: Found, b: Found, c: Found, turn: int, rng: np.random.Generator, time: float) -> Values:
    """Where a walker looks next: on by the difference of two others."""
    at = coordinates(now.loop, time)
    little = np.array(LITTLE[: len(at)])
    little[1:3] *= share_of_lags(now.loop, time)
    ahead = at + little * rng.normal(size=len(at)) * (1.0 if turn < 3 else 0.3)
    step = 2.38 / math.sqrt(2.0 * len(at)) if turn % 5 else 1.0
    ahead += step * (coordinates(b.loop, time) - coordinates(c.loop, time))
    ahead[1:3] = np.abs(ahead[1:3])
    if len(at) > 3:
        ahead[4] = 1.0 - abs(1.0 - abs(ahead[4]))  # J/S stays between 0 and 1
    return ahead


def _middle(kept: Sequence[Found], time: float) -> tuple[Found, tuple[Loop, ...]]:
    """The loop next to all medians, and loops from the whole walk."""
    at = np.array([[*coordinates(one.loop, time), math.log(abs(one.loop.K) + 1e-300)] for one in kept])
    middle = np.median(at, axis=0)
    spread = np.median(np.abs(at - middle), axis=0) + 1e-9
    best = kept[int(np.argmin(np.sum(((at - middle) / spread) ** 2, axis=1)))]
    picked = [kept[int(i)].loop for i in np.linspace(0, len(kept) - 1, KEPT - 1)]
    return best, (best.loop, *picked)
