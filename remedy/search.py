"""Find the loops that tell a record: the likeliest, and a sample of those that are about as likely.

    1  without stick: lag and dead time on a grid, self-regulating and integrating, the best made better
    2  with stick: sizes about what ``stickslip.detect.likelihood`` finds, J/S of 0 to 1, both laws; the best made
    better
    3  an ensemble: a walk of Metropolis through all that is free, each step taken with min(1, exp((nll - nll') / T))

T = ``TEMPER`` > 1 makes the ensemble wider than the likelihood says, because no real valve is the model's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from stickslip.remedy.process import Day, Left, Loop, settled, start_noise, told

__all__ = ["Found", "best_with", "best_without", "ensemble_of"]

Floats = NDArray[np.float64]
SHARES = tuple(0.55 * 1.15**i for i in range(8))  # of the S that is expected: 0.55 to 1.5
JUMPS = (0.0, 0.3, 0.7)
LAGS = (0.04, 0.1, 0.25, 0.6, 1.5, 4.0)  # of the time between two turns of OP
DELAYS = (0.0, 0.05, 0.15, 0.3)
TEMPER = 6.0
WALK, KEPT = 500, 24
SLOWEST = 20.0  # of the time between two turns of OP: a lag beyond is an integrator
WORSE = 1e9
LONGEST = 100.0  # rows of dead time: each stem of the bank remembers as many


@dataclass(frozen=True, eq=False)
class Found:
    """A loop, the noise of each day, and their negative log-likelihood [nats]."""

    loop: Loop
    noises: tuple[Left, ...]
    nll: float


def _weighed(days: Sequence[Day], one: Loop, noises: Sequence[Left], rounds: int = 2) -> Found:
    """The loop with the gain and the noise that go with it."""
    best = None
    for _ in range(rounds):
        said = told(days, one, noises)
        one, noises, _ = settled(days, one, said.shown)
        nll = told(days, one, noises).nll
        if best is None or nll < best.nll:
            best = Found(one, tuple(noises), nll)
    assert best is not None
    return best


def _time(days: Sequence[Day]) -> float:
    """Time between two turns of OP [s]."""
    return float(np.median([day.between * day.dt for day in days]))


def _late(days: Sequence[Day]) -> float:
    """What dead times are measured by [s]: the time between two turns, or what keeps them within ``LONGEST`` rows."""
    return min(_time(days), LONGEST * days[0].dt / 0.3)


def best_without(days: Sequence[Day], integrating: bool | None, way: float) -> list[Found]:
    """The likeliest loop without stick of each kind of process that may be, the likeliest first; ``way``: sign of K."""
    time, noises = _time(days), start_noise(days)
    found = []
    for kind in (False, True) if integrating is None else (integrating,):
        tried = [
            _weighed(days, Loop(False, 0.0, 0.0, kind, way, lag * time, 0.0, late * _late(days)), noises, 1)
            for lag in (LAGS if not kind else LAGS[:1])
            for late in DELAYS
        ]
        found.append(_better(days, min(tried, key=lambda one: one.nll), 120))
    return sorted(found, key=lambda one: one.nll)


def best_with(days: Sequence[Day], start: Found, S: float) -> Found:
    """The likeliest loop that sticks, from one without and the S that is expected [unit of OP]."""
    time, tried = _time(days), []
    spread = max(float(np.std(day.pv)) for day in days)
    moved = 0.5 * max(S, *(float(np.std(day.op)) for day in days))
    if start.loop.integrating:  # half a wave of the stem makes the swing
        K, lags = spread / (moved * 0.5 * time), [(start.loop.tau, late * time) for late in (0.0, 0.06, 0.25)]
    else:
        K, lags = spread / moved, [(lag * time, 0.0) for lag in LAGS[:4]]
    delays = tuple(share * _late(days) for share in (0.02, 0.05, 0.15))
    for follows, share, jump in product((False, True), SHARES, JUMPS):
        if follows and jump == 0.0:  # play, as the other law has it
            continue
        one = replace(start.loop, follows=follows, S=share * S, J=jump * share * S, K=math.copysign(K, start.loop.K))
        own = [
            _weighed(days, replace(one, tau=tau, tau_2=tau_2, theta=theta), start_noise(days), 1)
            for (tau, tau_2), theta in product(lags, delays)
        ]  # fmt: skip
        tried.append(min(own, key=lambda each: each.nll))
    tried.sort(key=lambda one: one.nll)
    kinds: dict[tuple[bool, float], Found] = {}  # the best of each law and jump
    for each in tried:
        kinds.setdefault((each.loop.follows, round(each.loop.J / each.loop.S, 2)), each)
    refined = sorted((_better(days, one, 60) for one in kinds.values()), key=lambda one: one.nll)
    return min((_better(days, _better(days, one, 80), 80) for one in refined[:2]), key=lambda one: one.nll)


def _coordinates(one: Loop, time: float) -> Floats:
    own = [] if one.integrating else [math.log(one.tau)]
    stick = [math.log(one.S), one.J / one.S] if one.S > 0.0 else []
    K = math.log(max(abs(one.K), 1e-300))
    return np.array([*own, one.theta / (0.1 * time), one.tau_2 / (0.1 * time), K, *stick])


def _loop(one: Loop, at: Floats, time: float, dt: float) -> Loop | None:
    """The loop at these coordinates; None where there is none."""
    k = 0 if one.integrating else 1
    if np.abs(at).max() > 200.0:
        return None
    tau = one.tau if one.integrating else math.exp(float(at[0]))
    theta, tau_2 = 0.1 * time * float(at[k]), 0.1 * time * float(at[k + 1])
    if not (0.0 <= theta <= min(0.6 * time, LONGEST * dt) and 0.0 <= tau_2 <= 3.0 * time):
        return None
    if not one.integrating and not (0.1 * dt < tau < SLOWEST * time and tau_2 <= tau):
        return None
    K = math.copysign(math.exp(float(at[k + 2])), one.K)
    made = replace(one, tau=tau, theta=theta, tau_2=tau_2, K=K)
    if one.S <= 0.0:
        return made
    S, jump = math.exp(float(at[k + 3])), float(at[k + 4])
    return replace(made, S=S, J=jump * S) if 0.0 <= jump <= 1.0 else None


def _better(days: Sequence[Day], start: Found, evaluations: int) -> Found:
    """The likeliest loop near a start, by the simplex of Nelder and Mead, and the noise that goes with it."""
    from scipy.optimize import minimize

    time, dt = _time(days), days[0].dt
    if start.loop.K == 0.0:
        return start

    def loss(at: Floats) -> float:
        one = _loop(start.loop, at, time, dt)
        return WORSE if one is None else told(days, one, start.noises).nll

    at = _coordinates(start.loop, time)
    sizes = [0.3, 0.4, 0.3, 0.15, 0.08, -0.15 if start.loop.J > 0.5 * start.loop.S else 0.15][start.loop.integrating :]
    simplex = np.vstack([at, at + np.diag(sizes[: len(at)])])
    found = minimize(
        loss, at, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": evaluations, "xatol": 1e-4}
    )
    one = _loop(start.loop, found.x, time, dt)
    if one is None:
        return start
    ahead = min((_weighed(days, one, start.noises, 1), Found(one, start.noises, float(found.fun))), key=lambda f: f.nll)
    return min(start, ahead, key=lambda f: f.nll)


def ensemble_of(days: Sequence[Day], best: Found, seed: int = 0) -> tuple[Loop, ...]:
    """``KEPT`` loops about as likely as the best, which is the first.

    The walk's step is scaled while it burns in, so that about a third of its steps is taken.
    """
    rng = np.random.default_rng(seed)
    time, dt = _time(days), days[0].dt
    at, nll, one = _coordinates(best.loop, time), best.nll, best.loop
    first = 0 if one.integrating else 1
    scale = np.array([*[0.1] * first, 0.2, 0.2, 0.05, *([0.03, 0.05] if one.S > 0.0 else [])])
    size, burn, spread = 1.0, WALK // 2, np.diag(scale**2)
    kept: list[Loop] = []
    past = [at]
    for step in range(WALK):
        ahead = at + rng.multivariate_normal(np.zeros(len(at)), spread) * size
        ahead[first : first + 2] = np.abs(ahead[first : first + 2])
        if best.loop.S > 0.0:
            ahead[-1] = abs(ahead[-1]) if ahead[-1] < 1.0 else 2.0 - ahead[-1]
        tried, taken = _loop(best.loop, ahead, time, dt), False
        if tried is not None:
            loss = told(days, tried, best.noises).nll
            if math.log(rng.random()) < (nll - loss) / TEMPER:
                at, nll, one, taken = ahead, loss, tried, True
        past.append(at)
        if step < burn:
            size *= math.exp(0.15 * (taken - 0.3))
            if step == burn // 2:
                own = np.atleast_2d(np.cov(np.array(past[burn // 6 :]).T))
                spread, size = own + 0.02 * np.diag(scale**2), 2.0 / math.sqrt(len(at))
        else:
            kept.append(one)
    return (best.loop, *(kept[i] for i in np.linspace(0, len(kept) - 1, KEPT - 1).astype(int)))
