"""Find the loops that tell a record best, without stick and with it.

1  without stick: lag and dead time on a grid, self-regulating and integrating, the best made better
2  with stick: ``DRAWN`` loops of both laws and kinds about the size that ``stickslip.detect.likelihood`` finds; in
   ``STAGES``, the best are made better by the simplex of Nelder and Mead, gain and noise following each try
3  loops whose slips look like those of the best one: other J with K J as it is, other dead times, bands anew
4  the other kind of process, with the valve that is found
5  the processes of these loops without stick: a stick gains nothing by a process that was found with it alone
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.remedy.left import Left
from stickslip.remedy.process import Day, Found, Loop, predicted, profiled, settled, start_noise
from stickslip.remedy.slips import banded

__all__ = ["at_coordinates", "best_with", "best_without", "coordinates", "freed", "half_wave", "share_of_lags"]

LEAST, MOST = 0.01, 0.5  # of the breakaways' spread r
DRAWN, TURNS = 100, 7  # loops that stick, to start from, and turns of bands and path for each
WIDE, NARROWER = 0.3, 0.75  # r at first, and over that of the turn before
STAGES = ((10, 24), (4, 40), (2, 80))  # how many are made better, by how many tries; the last in all rows, bands too
JUMPS, LATE = (0.1, 0.3, 0.5, 0.7, 0.9), (0.0, 1.0, 3.0)  # J over S and dead times [rows] of what may look alike
AGAIN = 2  # starts in one more place each that are made better
PLAIN, CROSSED = 120, 160  # tries of a loop without stick, and of the other kind of process
LAGS = 9  # without stick, from a row to four times the time between two turns of OP
DELAYS = (0.0, 0.05, 0.15, 0.3)  # of that time, or of three lags
RIVALS = 6  # loops that are kept beside the best
BEHIND = 80.0  # nats, that the best of a law and kind may be behind to be made better
SLOWEST = 20.0  # of the time between two turns of OP: a lag beyond is an integrator
WORSE = 1e9
LONGEST = 100.0  # rows of dead time: each stem of the bank remembers as many


def _weighed(days: Sequence[Day], one: Loop, noises: Sequence[Left], rounds: int = 2) -> Found:
    """The loop with the gain and the noise that go with it."""
    said, best = predicted(days, one, noises), Found(one, tuple(noises), WORSE)
    for _ in range(rounds):
        one, noises = settled(days, one, said.shown)
        said = predicted(days, one, noises)
        best = min(best, Found(one, noises, said.nll), key=lambda found: found.nll)
    return best


def half_wave(days: Sequence[Day]) -> float:
    """Time between two turns of OP [s]."""
    return float(np.median([day.between * day.dt for day in days]))


def _late(days: Sequence[Day]) -> float:
    """What dead times are measured by [s]: the time between two turns, or what keeps them within ``LONGEST`` rows."""
    return min(half_wave(days), LONGEST * days[0].dt / 0.3)


def best_without(days: Sequence[Day], integrating: bool | None, way: float) -> list[Found]:
    """The likeliest loop without stick of each kind of process that may be, the likeliest first; ``way``: sign of K."""
    time, found, coarse = half_wave(days), [], [day.coarse for day in days]
    for kind in (False, True) if integrating is None else (integrating,):
        noises = start_noise(coarse, kind)
        lags = [time] if kind else np.geomspace(days[0].dt, 4.0 * time, LAGS).tolist()
        tried = [
            _weighed(coarse, Loop(False, 0.0, 0.0, kind, way, lag, 0.0, late * min(_late(days), 3.0 * lag)), noises, 1)
            for lag in lags for late in DELAYS
        ]  # fmt: skip
        best = sorted(tried, key=lambda one: one.nll)[:AGAIN]
        found.append(min((_near(days, one.loop, PLAIN) for one in best), key=lambda one: one.nll))
    return sorted(found, key=lambda one: one.nll)


def best_with(days: Sequence[Day], starts: Sequence[Found], S: float, seed: int = 0) -> list[Found]:
    """The likeliest loops that stick, the likeliest first.

    starts : the best without stick of each kind of process;  S : as expected [unit of OP]
    """
    rng, late, fine, days = np.random.default_rng(seed), _late(days), days, [day.coarse for day in days]
    time, noises = half_wave(days), [start_noise(days, kind) for kind in (False, True)]
    spread = max(float(np.std(day.pv)) for day in days)
    moved = 0.5 * max(S, *(float(np.std(day.op)) for day in days))
    tried = []
    for i in range(DRAWN):
        start = starts[i % len(starts)].loop
        tau = time * math.exp(rng.uniform(math.log(0.03), math.log(3.0)))
        own = S * math.exp(rng.uniform(math.log(0.5), math.log(2.5)))
        one = Loop(
            bool(rng.random() < 0.5), own, own * rng.uniform(0.0, 0.9), start.integrating, start.K, tau,
            rng.uniform(0.0, 0.5) * (0.3 * time if start.integrating else tau), late * 0.2 * rng.random() ** 2, WIDE,
        )  # fmt: skip
        size = spread / (moved * (0.5 * time if one.integrating else 1.0)) * 3.0 ** rng.uniform(-0.5, 1.0)
        one = replace(one, K=math.copysign(size, start.K))
        tried.append(_in_turns(days, one, noises[one.integrating]))
    for kept, evaluations in STAGES:
        whole = kept == STAGES[-1][0]
        if whole:
            days, tried = fine, [_weighed(fine, one.loop, start_noise(fine, one.loop.integrating)) for one in tried]
        tried = _apart(tried)
        tried = [*(_better(days, one, evaluations, whole) for one in tried[:kept]), *tried[kept:RIVALS]]
    best = min(tried, key=lambda one: one.nll)
    others = [_in_turns(days, one, best.noises) for one in _alike(best.loop, days[0].dt)]
    tried += [_better(days, one, STAGES[-1][1]) for one in sorted(others, key=lambda one: one.nll)[:AGAIN]]
    if len(starts) > 1:
        tried.append(_of_the_other_kind(days, min(tried, key=lambda one: one.nll)))
    return sorted(tried, key=lambda one: one.nll)


def freed(days: Sequence[Day], stuck: Sequence[Found]) -> list[Found]:
    """The likeliest loops without stick near the processes of those that stick, the likeliest of each kind."""
    kinds = {one.loop.integrating: replace(one.loop, S=0.0, J=0.0) for one in reversed(stuck)}
    return [_near(days, one, PLAIN) for one in kinds.values()]


def _of_the_other_kind(days: Sequence[Day], best: Found) -> Found:
    """The likeliest loop whose process is of the other kind, from the valve and the fast answer of the best one.

    Where the search has found the valve with one kind alone, the other one has lost by its valve, not by its kind.
    """
    one, kind = best.loop, not best.loop.integrating
    slow = max(one.tau, days[0].dt) if kind else half_wave(days)
    other = replace(one, integrating=kind, tau=slow, K=one.K / slow if kind else one.K * slow)
    return _near(days, other, CROSSED)


def _near(days: Sequence[Day], one: Loop, tries: int) -> Found:
    """The likeliest loop near this one."""
    return _better(days, _weighed(days, one, start_noise(days, one.integrating)), tries)


def _alike(one: Loop, dt: float) -> list[Loop]:
    """Loops whose slips look alike: a smaller J behind a larger gain, a smaller S behind a longer dead time.

    The simplex does not go along these ridges.  The bands follow the path.
    """
    slip = one.K * max(one.J, JUMPS[0] * one.S)
    return [
        replace(one, J=J * one.S, K=slip / (J * one.S), theta=late * dt, r=0.5 * WIDE) for J in JUMPS for late in LATE
    ]  # fmt: skip


def _in_turns(days: Sequence[Day], one: Loop, noises: Sequence[Left]) -> Found:
    """The likeliest of ``TURNS`` loops, each with the bands, gain and noise that the path of the last one asks for."""
    turns, left = [], tuple(noises)
    for _ in range(TURNS):
        said = predicted(days, one, left)
        turns.append(Found(one, left, said.nll))
        one, left = _followed(days, one, said.shown, NARROWER)
    return min(turns, key=lambda each: each.nll)


def _followed(
    days: Sequence[Day], one: Loop, shown: Sequence[Values], narrower: float = 1.0
) -> tuple[Loop, tuple[Left, ...]]:
    """The loop with the gain, the noise and the bands that its likely path asks for; r is at most ``narrower`` r.

    A path that is free to slip anywhere asks for a wider r still, where the noise is large.
    """
    one, left = settled(days, one, shown)
    return banded(days, one, shown, LEAST, max(narrower * one.r, LEAST)), left


def _apart(tried: Sequence[Found]) -> list[Found]:
    """The likeliest first, the best of each law and kind before the rest."""
    tried = sorted(tried, key=lambda one: one.nll)
    kinds: dict[tuple[bool, bool], int] = {}
    for i, each in enumerate(tried):
        kinds.setdefault((each.loop.follows, each.loop.integrating), i)
    first = sorted(i for i in kinds.values() if tried[i].nll < tried[0].nll + BEHIND)
    return [tried[i] for i in first] + [one for i, one in enumerate(tried) if i not in first]


def coordinates(one: Loop, time: float) -> Values:
    """All that is free (6,) or, without stick, (3,); not K, which follows by least squares; ``time``: ``half_wave``."""
    stick = [math.log(one.S), one.J / one.S, math.log(one.r)] if one.S > 0.0 else []
    return np.array([math.log(one.tau), one.theta / (0.1 * time), one.tau_2 / (0.1 * time), *stick])


def share_of_lags(one: Loop, time: float) -> float:
    """By how much steps of dead time and second lag are smaller where a loop is fast beside its turns (0 to 1)."""
    return min(1.0, 3.0 * (one.tau + one.tau_2 + one.theta) / time)


def at_coordinates(one: Loop, at: Values, time: float, dt: float) -> Loop | None:
    """The loop at these coordinates; None where there is none."""
    if np.abs(at).max() > 200.0:
        return None
    tau = one.tau if one.integrating else math.exp(float(at[0]))
    theta, tau_2 = 0.1 * time * float(at[1]), 0.1 * time * float(at[2])
    if not (0.0 <= theta <= min(0.6 * time, LONGEST * dt) and 0.0 <= tau_2 <= 3.0 * time):
        return None
    if not one.integrating and not (0.1 * dt < tau < SLOWEST * time and tau_2 <= tau):
        return None
    made = replace(one, tau=tau, theta=theta, tau_2=tau_2)
    if len(at) < 4:
        return made
    S, jump, r = math.exp(float(at[3])), float(at[4]), math.exp(float(at[5]))
    return replace(made, S=S, J=jump * S, r=r) if 0.0 <= jump <= 1.0 and LEAST <= r <= MOST else None


def _better(days: Sequence[Day], start: Found, evaluations: int, whole: bool = True) -> Found:
    """The likeliest loop near a start, by the simplex of Nelder and Mead; gain and noise follow each try.

    ``whole``: the bands of the stem are tried too; else they follow as well.
    """
    from scipy.optimize import minimize

    time, dt, best = half_wave(days), days[0].dt, start
    if start.loop.K == 0.0:
        return start
    at = coordinates(start.loop, time)
    late = share_of_lags(start.loop, time)
    sizes = [0.3, 0.4 * late, 0.3 * late, 0.04, -0.08 if start.loop.J > 0.5 * start.loop.S else 0.08, 0.4]
    free = range(1 if start.loop.integrating else 0, len(at) if whole else 3)  # an integrator has no tau

    def loss(own: Values) -> float:
        nonlocal best
        there = at.copy() if whole else at[:3].copy()
        there[free] = own
        one = at_coordinates(best.loop, there, time, dt)
        if one is None:
            return WORSE
        if whole:
            found = profiled(days, one, best.noises)
        else:
            after = _followed(days, one, predicted(days, one, best.noises).shown)
            found = Found(*after, predicted(days, *after).nll)
        best = min(best, found, key=lambda each: each.nll)
        return found.nll

    first = at[free]
    minimize(
        loss, first, method="Nelder-Mead",
        options={
            "initial_simplex": np.vstack([first, first + np.diag(np.array(sizes)[free])]), "maxfev": evaluations,
            "xatol": 1e-4,
        },
    )  # fmt: skip
    return best
