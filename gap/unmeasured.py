"""The rival of every effect: none at all, but a load at a feed that nobody measures, as it has to be to explain PV.

    e = h * a + w      innovations; h their response to a load of 1 in one interval, a the load, w white, of variance 1
    S(f) = I + s(f) h(f) h(f)^*                              s spectrum of the load, one height in each octave of f
    F = sum rho(S^(-1/2) e) + 1/2 sum over f of ln det S     (Whittle 1953; rho the loss of all scores)

A load that is free explains any PV; that OP follows as the controller is modelled, and that PV moves between rows as
the process does, it cannot feign.  The determinant is the price of its freedom: an effect with one size that explains
as much is better by it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gap.effects.disturbance import Disturbance
from gap.floor import scored
from gap.loads import response
from gap.problem import Problem

Floats = NDArray[np.float64]
HEIGHTS = 120  # of an octave of the spectrum that are tried
PRICE = 12.0  # nats of each octave in which there is a load, beyond the first
FORGOTTEN = 0.02  # share of the response that may be left in the last tenth of the record
EVEN = 1e-6  # share by which intervals may differ


class AnyLoad(Disturbance):
    """A load at a feed of which nothing is known."""

    name = "unmeasured load"


@dataclass(frozen=True)
class UnmeasuredLoad:
    """A load at ``place`` with no plan: ``sd`` [its unit] and the ``period`` [s] above which half of its power lies.

    ``F`` score with the price of its freedom, ``left`` the score of what it leaves, of which no more than ``limit`` is
    without a gap.
    """

    place: str
    unit: str
    sd: float
    period: float
    F: float
    left: float
    limit: float

    @property
    def explains(self) -> bool:
        """Whether it leaves no more than records without a gap have."""
        return self.left <= self.limit

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "-") else ""
        return (
            f"a load at {self.place} that nobody measures, of standard deviation {self.sd:.2g}{unit}, "
            f"half of it slower than {self.period:.2g} s"
        )


def unmeasured_load(problem: Problem, allowed: float) -> UnmeasuredLoad | None:
    """Return the load that suits the record best; ``allowed`` nats more than records without a gap have.

    None where the model has no feed, rows are uneven, or the record is too short for what a load leaves behind.
    """
    t = problem.record.log.t
    if np.ptp(np.diff(t)) > EVEN * problem.record.log.dt or problem.record.filter is not None:
        return None
    found = [
        one
        for place in AnyLoad().places(problem.quiet)
        if not problem.record.suspects or place in problem.record.suspects
        for hold in ("previous", "linear")
        if (one := _fitted(problem, place, hold, allowed)) is not None
    ]
    return min(found, key=lambda one: one.F, default=None)


def _fitted(problem: Problem, place: str, hold: Literal["previous", "linear"], allowed: float) -> UnmeasuredLoad | None:
    e = np.nan_to_num(problem.as_it_is)
    n = len(e)
    h = response(problem, problem.quiet, place, hold)
    if h is None or not forgotten(h):
        return None
    whole = np.zeros_like(e)
    whole[: min(len(h), n)] = h[:n]
    E, H = np.fft.rfft(e, axis=0) / math.sqrt(n), np.fft.rfft(whole, axis=0)
    gain, hit = (np.abs(H) ** 2).sum(axis=1), (np.conj(H) * E).sum(axis=1)
    weight = np.full(len(gain), 2.0)
    weight[0] = 1.0
    if n % 2 == 0:
        weight[-1] = 1.0
    s = _spectrum(gain, np.abs(hit) ** 2, weight)
    kept = 1.0 / np.sqrt(1.0 + s * gain)
    left = E - H * (hit * (1.0 - kept) / np.maximum(gain, 1e-300))[:, None]
    white = np.fft.irfft(left * math.sqrt(n), n, axis=0)
    white[~np.isfinite(problem.as_it_is)] = np.nan
    score = float(scored(white))
    octaves = len({round(v, 12) for v in s[s > 0.0].tolist()})
    freedom = 0.5 * float(weight @ np.log1p(s * gain)) + PRICE * max(octaves - 1, 0)
    power = np.cumsum((weight * s)[1:])
    k = 1 + int(np.searchsorted(power, 0.5 * power[-1])) if power[-1] > 0.0 else 1
    signal = str(problem.quiet[place].output_labels[0])
    return UnmeasuredLoad(
        place,
        problem.quiet.signal_units.get(signal, ""),
        math.sqrt(float(weight @ s) / n),
        n * problem.record.log.dt / k,
        score + freedom,
        score,
        problem.limit + allowed,
    )


def forgotten(h: Floats) -> bool:
    """Return whether a response (rows, signals) has died away before its last tenth, as Fourier series want it."""
    last = np.abs(h[-max(len(h) // 10, 1) :]).max(axis=0)
    return bool((last <= FORGOTTEN * np.abs(h).max(axis=0)).all())


def _spectrum(gain: Floats, power: Floats, weight: Floats) -> Floats:
    """Return the height of a load's spectrum at each frequency, equal within octaves, that is most likely.

    max over s of  sum of weight/2 (s power/(1 + s gain) - ln(1 + s gain))
    """
    s = np.zeros(len(gain))
    for rows in octaves(len(gain)):
        g, q, w = gain[rows], power[rows], weight[rows]
        top = float(np.max(q / np.maximum(g, 1e-300) ** 2, initial=0.0))
        if not (top > 0.0 and np.isfinite(top)):
            continue
        heights = np.append(0.0, np.geomspace(1e-6 * top, top, HEIGHTS))[:, None]
        likely = 0.5 * ((heights * q / (1.0 + heights * g) - np.log1p(heights * g)) @ w)
        s[rows] = heights[int(np.argmax(likely)), 0]
    return s


def octaves(n: int) -> Sequence[NDArray[np.int64]]:
    """Return the frequencies 0 ... n - 1 in groups, each up to twice as high as the one before.

    >>> [one.tolist() for one in octaves(6)]
    [[0, 1], [2, 3], [4, 5]]
    """
    ends = [0, *(2**k for k in range(1, 64) if 2**k < n), n]
    return [np.arange(a, b) for a, b in pairwise(ends)]
