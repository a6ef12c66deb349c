"""Two times of one loop predicted together: valve and process are shared but for one part, and what that part gains.

    gain(part) = nll(all shared) - nll(all shared but the part)                    [nats]

Load and noise are each time's own.  Starts are the loops of both fits, each with that part of the other fit's middle
loop on the other side; the best is made better by the simplex of Nelder and Mead.  A bank's likelihood varies with its
random numbers: what is found is weighed with ``DRAWS`` others, and the mean counts.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from stickslip.remedy.left import Left
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.process import Loop, predicted, settled
from stickslip.remedy.search import WORSE, at_coordinates, coordinates, half_wave

__all__ = ["PARTS", "Pair", "Together"]

Floats = NDArray[np.float64]
Noises = tuple[tuple[Left, ...], tuple[Left, ...]]
GAIN = "process_gain"  # is no coordinate: it follows by least squares
PARTS = {"stiction": (3, 4), GAIN: (), "process_time_constant": (0, 2), "dead_time": (1,)}  # coordinates that differ
STARTS = 6  # loops of each fit
TRIES, MORE = 110, 60  # of the simplex: all shared, and from there with a part of its own
FREE = 1e-3  # of OP's spread: S of a stem that does not stick
STEPS = (0.3, 0.4, 0.3, 0.08, 0.12, 0.4)  # of the simplex, and of what differs
DRAWS = 8  # of random numbers


@dataclass(frozen=True, eq=False)
class Together:
    """The loops and noises of the earlier and the later time, and their negative log-likelihood [nats]."""

    loops: tuple[Loop, Loop]
    noises: Noises
    nll: float


class Pair:
    """Two fits of one loop: the likeliest loops of which all is ``shared``, and those of which a part is its ``own``.

    scan : [s];  between : samples between two turns of OP;  smallest : S [unit of OP], below which a stem is free

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> day = fit(sticky())
    >>> Pair(day, day).gain("process_gain") < 3.0  # nothing has changed
    True
    """

    def __init__(self, earlier: LoopFit, later: LoopFit) -> None:
        fits = (earlier, later)
        self._sides = (earlier.days, later.days)
        days = (*earlier.days, *later.days)
        self._time, self.scan = half_wave(days), max(day.dt for day in days)
        self.between = max(1, round(self._time / self.scan))
        small = FREE * max(float(np.std(day.op)) for day in days)
        self.smallest = 30.0 * small
        self._middles = [_sticking(fit.best, small) for fit in fits]
        picked = [[fit.loops[int(i)] for i in np.linspace(0, len(fit.loops) - 1, STARTS)] for fit in fits]
        self._starts = [(side, _sticking(one, small)) for side in (0, 1) for one in picked[side]]
        noises: Noises = (earlier.found.noises, later.found.noises)
        begun = _best(self._predicted((one, one), noises) for _, one in self._starts)
        begun = self._better(begun)
        own = {part: self._better(self._begun(part, begun), part) for part in PARTS}
        likely = _best(own.values())
        again = self._better(_best(self._predicted((one, one), likely.noises) for one in likely.loops))
        alike = [replace(each, loops=(one, one)) for each in own.values() for one in each.loops]
        self.shared = _best(self._weighed(one) for one in (begun, again, *alike))  # the likeliest may be so by luck
        self.own = {part: self._weighed(one, part) for part, one in own.items()}

    def gain(self, part: str) -> float:
        """What it gains to let a part differ [nats]."""
        return self.shared.nll - self.own[part].nll

    def lefts(self, one: Together) -> list[list[Floats]]:
        """What the loops leave of PV in each record of each time, beside the flow of the valve at the mean OP."""
        middle = float(np.mean([day.op.mean() for days in self._sides for day in days]))
        return [
            [
                day.pv[: own.shape[1]] - loop.K * (own[1] + (0.0 if loop.integrating else day.op[0] - middle))
                for day, own in zip(days, predicted(days, loop, noise).shown, strict=True)
            ]
            for days, loop, noise in zip(self._sides, one.loops, one.noises, strict=True)
        ]

    def _begun(self, part: str, shared: Together) -> Together:
        """The likeliest start of loops of which a part differs."""
        free = list(PARTS[part])
        tried = [shared]
        for side, one in self._starts:
            other = self._middles[1 - side]
            if other.integrating != one.integrating:
                continue
            at = coordinates(one, self._time)
            at[free] = coordinates(other, self._time)[free]
            mixed = at_coordinates(one, at, self._time, self.scan)
            if mixed is not None:
                tried.append(self._predicted((mixed, one) if side else (one, mixed), shared.noises, part))
        return _best(tried)

    def _predicted(self, loops: tuple[Loop, Loop], noises: Noises, part: str = "", draw: int = 0) -> Together:
        """Both times with these loops; gain and noise follow."""
        both = list(zip(self._sides, loops, noises, strict=True))
        shown = [predicted(days, one, noise, draw).shown for days, one, noise in both]
        if part == GAIN:
            done = [settled(days, one, own)[:2] for (days, one, _), own in zip(both, shown, strict=True)]
        else:
            one, left, _ = settled((*self._sides[0], *self._sides[1]), loops[0], (*shown[0], *shown[1]))
            first = len(self._sides[0])
            done = [(one, left[:first]), (replace(loops[1], K=one.K), left[first:])]
        nll = sum(predicted(days, *own, draw).nll for days, own in zip(self._sides, done, strict=True))
        return Together((done[0][0], done[1][0]), (tuple(done[0][1]), tuple(done[1][1])), nll)

    def _better(self, start: Together, part: str = "") -> Together:
        """The likeliest loops near a start; the later one differs by as many coordinates as the part has."""
        free, best = list(PARTS.get(part, ())), start
        first, second = (coordinates(one, self._time) for one in start.loops)
        moved = list(range(1 if start.loops[0].integrating else 0, len(first)))  # tau means nothing in an integrator
        free = [i for i in free if i in moved]
        steps = np.array([*(STEPS[i] for i in moved), *(STEPS[i] for i in free)])
        if start.loops[0].J > 0.5 * start.loops[0].S:
            steps[moved.index(4)] *= -1.0

        def loss(own: Floats) -> float:
            nonlocal best
            at, late = first.copy(), np.zeros(len(first))
            at[moved], late[free] = own[: len(moved)], own[len(moved) :]
            pair = [
                at_coordinates(one, where, self._time, self.scan)
                for one, where in zip(best.loops, (at, at + late), strict=True)
            ]
            if pair[0] is None or pair[1] is None:
                return WORSE
            found = self._predicted((pair[0], pair[1]), best.noises, part)
            best = _best((best, found))
            return found.nll

        at = np.array([*first[moved], *(second - first)[free]])
        simplex, most = np.vstack([at, at + np.diag(steps)]), MORE if part else TRIES
        minimize(loss, at, method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": most, "xatol": 1e-4})
        return best

    def _weighed(self, one: Together, part: str = "") -> Together:
        """The same loops, by the mean of their likelihood over draws that did not serve to find them."""
        return replace(
            one,
            nll=float(
                np.mean([self._predicted(one.loops, one.noises, part, draw).nll for draw in range(1, DRAWS + 1)])
            ),
        )


def _best(those: Iterable[Together]) -> Together:
    return min(those, key=lambda one: one.nll)


def _sticking(one: Loop, small: float) -> Loop:
    """A loop as it is, or with a stick too small to matter where it has none."""
    return one if one.S > 0.0 else replace(one, S=small, J=0.0)
