"""The loops of one time on the log of the other: how likely that log is, and what one part that differs gains.

    cost = T (x - m)' C^-1 (x - m) / 2 + nll(other log; x, or x and what differs),   x ~ N(m, C): the fitted loops
    gain(part) = least cost where nothing differs - least cost where the part does        [nats]

T is the temperature of the population, so that the loops of one time weigh as much as the log of the other.  The loops
are those of the time that shows a stick, which say more of the loop; where both do, or none, those of each time are
asked in turn: what differs by a fault of one fit does not differ the other way round.  Load and noise are each time's
own.  Each part is tried at some ``FACTORS`` beside some loops, and the best made better by the simplex of Nelder and
Mead.  r stays: a stem that may slip anywhere has any S.
A bank's likelihood varies with its random numbers.  It has no bias, its logarithm has: the mean of others counts.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from stickslip.remedy.left import Left
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.population import LITTLE, TEMPER
from stickslip.remedy.process import DRAWS, Found, Loop, beside, predicted
from stickslip.remedy.search import WORSE, at_coordinates, coordinates, half_wave

__all__ = ["PARTS", "Pair", "Together"]

Floats = NDArray[np.float64]
PARTS = {"stiction": (3, 4), "process_gain": (-1,), "process_time_constant": (0,), "dead_time": (1,)}  # what differs
FACTORS, GONE = (0.4, 0.6, 0.8, 1.25, 1.7, 2.5), 0.01  # of a part; of a dead time, of all that is late; of no stick
FAR = 1.6  # logarithm of a ratio of gains or lags, beyond which nobody believes it
STARTS, TRIES = 6, 70  # loops beside which a part is tried, and tries of the simplex
STEP = 0.4  # of what differs


@dataclass(frozen=True, eq=False)
class Together:
    """Values x of the known loop, what differs from them at the other time, both loops and noises, and the cost [nats].

    Loops and noises of the known time are first while they are sought, and those of the earlier time at last.
    """

    x: Floats
    differs: Floats
    loops: tuple[Loop, ...]
    noises: tuple[tuple[Left, ...], ...]
    cost: float


class Pair:
    """Two fits of one loop: the likeliest loops of which all is ``shared``, and those of which a part is its ``own``.

    backwards : whether the loops are the later time's;  scan : [s]

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> day = fit(sticky())
    >>> Pair(day, day).gain("process_gain") < 3.0  # nothing has changed
    True
    """

    def __init__(self, earlier: LoopFit, later: LoopFit, backwards: bool = False) -> None:
        self._fits, days, self._backwards = (earlier, later), (*earlier.days, *later.days), backwards
        self._known, self._other = (later, earlier) if backwards else (earlier, later)
        self._time, self.scan = half_wave(days), max(day.dt for day in days)
        at = np.array([self._values(one) for one in self._known.loops])
        little = np.array([*LITTLE[: at.shape[1] - 1], LITTLE[3]])
        self._middle, self._sure = np.median(at, axis=0), np.linalg.inv(np.cov(at.T) + np.diag(little**2))
        self._steps = np.sqrt(np.var(at, axis=0) + little**2)
        self._moved = [
            i for i in range(self._known.best.integrating, at.shape[1]) if i != 5
        ]  # an integrator has no tau
        still = np.zeros(at.shape[1])
        shared = self._likeliest((), [(x, still) for x in (self._middle, *at)])
        own = {}
        for part in PARTS:
            free = self._free(part)
            starts = [(x, off) for x in (shared.x, *at[:STARTS]) for off in self._offs(free, x)]
            own[part] = self._likeliest(free, [(shared.x, still), *starts])
        again = [self._tried(one.x, still, one.noises[1]) for one in own.values()]
        shared = self._weighed(min((shared, *again), key=lambda one: one.cost))  # the likeliest may be so by luck
        self.shared = min(shared, self._theirs(still), key=lambda one: one.cost)
        self.own = {part: self._weighed(one) for part, one in own.items()}

    def gain(self, part: str) -> float:
        """What it gains to let a part differ [nats]."""
        return self.shared.cost - self.own[part].cost

    def gone(self) -> float:
        """By how many nats the known loops tell the other log better without their stick than with it.

        No size is fitted: it is the mean of likelihoods over the population, each with load and noise of its own.
        """

        def nll(loop: Loop) -> float:
            found = beside(self._other.days, loop, self._other.without.noises)
            return beside(self._other.days, loop, found.noises).nll

        sticky = self._known.loops
        return _of_mean([nll(one) for one in sticky]) - _of_mean([nll(replace(one, S=0.0, J=0.0)) for one in sticky])

    def lefts(self, one: Together) -> tuple[list[list[Floats]], list[list[Floats]]]:
        """What the loops leave of PV in each record of each time, and the answers to the stem beside it.

        The known time's by its own likeliest loop, which leaves least of what is not there.
        """
        lefts, answers = [], []
        for fit, loop, noise in zip(self._fits, one.loops, one.noises, strict=True):
            loop = fit.found.loop if fit is self._known else loop
            answers.append([loop.K * path[1] for path in predicted(fit.days, loop, noise).shown])
            lefts.append([day.pv[: len(x)] - x for day, x in zip(fit.days, answers[-1], strict=True)])
        return lefts, answers

    def _values(self, one: Loop) -> Floats:
        """All that a loop may differ in: its coordinates and the logarithm of its gain."""
        return np.array([*coordinates(one, self._time), math.log(abs(one.K) + 1e-300)])

    def _loop(self, x: Floats) -> Loop | None:
        """The loop of these values; None where there is none."""
        best = self._known.best
        one = at_coordinates(best, x[:-1], self._time, self.scan) if abs(x[-1]) < 200.0 else None
        return one and replace(one, K=math.copysign(math.exp(float(x[-1])), best.K))

    def _free(self, part: str) -> tuple[int, ...]:
        """Which values the part is; none where the loop has it not."""
        if part == "process_time_constant" and self._known.best.integrating:
            return (2,)
        return (
            () if part == "stiction" and not self._known.sticks else tuple(i % len(self._middle) for i in PARTS[part])
        )

    def _offs(self, free: Sequence[int], x: Floats) -> Iterable[Floats]:
        """By how much the first of these values is tried to differ from x."""
        for factor in (*FACTORS, *((GONE,) if len(free) > 1 else ())) if free else ():
            off, late = np.zeros(len(x)), x[1] + x[2] + 10.0 * self.scan / self._time
            off[free[0]] = max((factor - 1.0) * late, -x[free[0]]) if free[0] in (1, 2) else math.log(factor)
            yield off

    def _tried(self, x: Floats, differs: Floats, noises: Sequence[Left], draw: int = 0) -> Together:
        """What it costs that the known time has the loop x, and the other one x + ``differs``."""
        here, there, own = self._loop(x), self._loop(x + differs), self._known.found.noises
        if here is None or there is None or max(abs(differs[0]), abs(differs[-1])) > FAR:
            return Together(x, differs, (self._known.best,) * 2, (own, tuple(noises)), WORSE)
        found, off = beside(self._other.days, there, noises, draw), x - self._middle
        cost = 0.5 * TEMPER * float(off @ self._sure @ off) + found.nll
        return Together(x, differs, (here, there), (own, found.noises), cost)

    def _likeliest(self, free: Sequence[int], starts: Sequence[tuple[Floats, Floats]]) -> Together:
        """The likeliest values of the known time, and of what is ``free`` at the other one, from the best start."""
        noises, moved, free = self._other.without.noises, self._moved, list(free)
        best = min((self._tried(*start, noises) for start in starts), key=lambda one: one.cost)
        first = np.array([*best.x[moved], *best.differs[free]])

        def cost(own: Floats) -> float:
            nonlocal best
            x, differs = best.x.copy(), np.zeros(len(best.x))
            x[moved], differs[free] = own[: len(moved)], own[len(moved) :]
            tried = self._tried(x, differs, best.noises[1])
            best = min(best, tried, key=lambda one: one.cost)
            return tried.cost

        simplex = np.vstack([first, first + np.diag([*self._steps[moved], *(STEP for _ in free)])])
        minimize(
            cost, first, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": TRIES, "xatol": 1e-4}
        )
        return best

    def _theirs(self, still: Floats) -> Together:
        """The likeliest loop of the other time for both logs: the known time's population may have missed it.

        That log is asked itself here, for no spread about a wrong middle says how unlikely it is with this loop.
        """
        one, fits = self._other.best, (self._known, self._other)
        known, there, base = (
            [beside(fit.days, loop, fit.found.noises, draw) for draw in DRAWS]
            for fit, loop in ((fits[0], one), (fits[1], one), (fits[0], fits[0].best))
        )  # fmt: skip

        def nll(found: Sequence[Found]) -> float:
            return _of_mean([each.nll for each in found])

        cost = max(nll(known) - nll(base), 0.0) + nll(there)
        return self._ordered(Together(self._values(one), still, (one, one), (known[0].noises, there[0].noises), cost))

    def _weighed(self, one: Together) -> Together:
        """The same by the mean of likelihoods over draws that did not serve to find it, the earlier time first."""
        costs = [self._tried(one.x, one.differs, one.noises[1], draw).cost for draw in DRAWS]
        return self._ordered(replace(one, cost=_of_mean(costs)))

    def _ordered(self, one: Together) -> Together:
        """The same, the earlier time first."""
        way = -1 if self._backwards else 1
        return replace(one, loops=one.loops[::way], noises=one.noises[::way])


def _of_mean(nlls: Sequence[float]) -> float:
    """The nll of the mean of likelihoods."""
    return math.log(len(nlls)) - float(np.logaddexp.reduce([-each for each in nlls]))
