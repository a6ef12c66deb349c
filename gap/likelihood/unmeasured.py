"""The rival of every effect: none at all, but a load at a feed that nobody measures, as it has to be to explain PV.

    e = h * a + w      innovations; h their response to a load of 1 in one interval, a the load, w white, of variance 1
    S(f) = I + s(f) h(f) h(f)^*                              s spectrum of the load, one height in each octave of f
    F = sum rho(S^(-1/2) e) + 1/2 sum over f of ln det S     (Whittle 1953; rho the loss of all scores)

What loads before the first row have left behind is a few shapes, which are fitted beside.  A load that is free explains
any PV; that OP follows as the controller is modelled, and that PV moves between rows as the process does, it cannot
feign.  The determinant is the price of its freedom: an effect with one size that explains as much is better by it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.left import GAINED, SIGMAS, known, level
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.sizes import response
from stickslip.gap.null_model.null_model import scored, without_gap
from stickslip.logs.arrays import Values

Complex = NDArray[np.complex128]
PULSE = 1e-3  # size of the load that shows the response, in spans of its signal
NULLS = 4  # runs without a gap
ROUNDS = 3  # of the spectrum and of what loads before the first row have left
TAILS, DISTINCT, MOST = 40, 1e-5, 6  # rows after a load of which the rest is looked at, and how many shapes that has
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

    ``gained`` nats by which it is likelier than the model alone, its freedom paid; ``left`` the score of what is left,
    of which no more than ``limit`` is without a gap; ``part`` of the gap that it explains.

    >>> print(UnmeasuredLoad("feed", "-", 0.0651, 112.0, 1.0, 1.0, 1.0, 1.0))
    a load at feed that nobody measures, of standard deviation 0.065, half of it slower than 110 s
    """

    place: str
    unit: str
    sd: float
    period: float
    gained: float
    left: float
    limit: float
    part: float

    @property
    def explains(self) -> bool:
        """Whether it leaves no more than records without a gap have."""
        return self.left <= self.limit

    def __str__(self) -> str:
        unit = f" {self.unit}" if self.unit not in ("", "-") else ""
        return (
            f"a load at {self.place} that nobody measures, of standard deviation {self.sd:.2g}{unit}, "
            f"half of it slower than {float(f'{self.period:.2g}'):g} s"
        )


def unmeasured_load(null: Fit) -> UnmeasuredLoad | None:
    """Return the load that fits the record best in place of an effect.

    None where the model has no feed, rows are uneven, or the record is too short for what a load leaves behind.
    """
    f = null.hypothesis.frame
    assert isinstance(f, Replays)
    t = f.record.log.t
    if np.ptp(np.diff(t)) > EVEN * f.record.log.dt or f.record.filter is not None:
        return None
    ways: tuple[Literal["previous", "linear"], ...] = ("previous", "linear")
    places = [p for p in AnyLoad().places(f.quiet) if not f.record.suspects or p in f.record.suspects]
    answers = [(p, response(null, p, PULSE * _span(f, p), way)) for p in places for way in ways]
    legal = [(p, h) for p, h in answers if h is not None and forgotten(h)]
    if not legal:
        return None
    e = null.best.e[f.skipped :]
    place, h = min(legal, key=lambda one: _suited(e, one[1])[0])
    F, left, sd, period = _suited(e, h)
    signal = str(f.quiet[place].output_labels[0])
    unit = f.quiet.signal_units.get(signal, "")
    usual, whole = level(null.best), float(scored(e))
    limit = usual + SIGMAS * f.null_model.sd * math.sqrt(known(null.best)) + GAINED
    part = float(np.clip((whole - left) / max(whole - usual, 1e-9), 0.0, 1.0))
    gained = whole - F - _without_gap(null, h)
    return UnmeasuredLoad(place, unit, sd, period * f.record.log.dt, gained, left, limit, part)


def said_of_rival(rival: UnmeasuredLoad, gained: float | None = None) -> str:
    """Return in words how a load that nobody measures does; ``gained`` nats by what is named, None if nothing is."""
    if gained is not None:
        more = gained - rival.gained
        if rival.explains and more <= GAINED:
            return (
                f"A disturbance alone may explain it: {rival}, leaves nothing; its log likelihood is {more:.0f} lower."
            )
        return f"A disturbance alone is excluded: {rival}, has a log likelihood that is {more:.0f} lower."
    if rival.explains:
        return f"A disturbance alone may explain it: {rival}, leaves nothing of the gap."
    left = 100.0 * (1.0 - rival.part)
    return f"A disturbance alone does not explain it: the best, {rival}, leaves {left:.1f} % of the gap."


def _span(f: Replays, place: str) -> float:
    low, high = f.quiet.signal_spans.get(str(f.quiet[place].output_labels[0]), (0.0, 1.0))
    return high - low


def _without_gap(null: Fit, h: Values) -> float:
    """Return how far a load lowers the score where there is no gap [nats]: rounding is not quite white."""
    one, f, found = null.hypothesis, null.hypothesis.frame, []
    for log in without_gap(f.model, f.record, NULLS, 1):
        left = tried(one.of(replace(f, record=replace(f.record, log=log))), null.best.values)
        if left is not None:
            e = left.e[f.skipped :]
            found.append(float(scored(e)) - _suited(e, h)[0])
    return max(0.0, float(np.mean(found))) if found else 0.0


def _suited(found: Values, h: Values) -> tuple[float, float, float, float]:
    """Return (F, score of what is left, sd [unit], period [rows]) of the load that suits innovations best."""
    e, n = np.nan_to_num(found), len(found)
    h = np.concatenate([h, np.zeros((max(n - len(h), 0), h.shape[1]))])[:n]
    before = earlier(h)
    U, H = (np.fft.rfft(one, axis=0) / math.sqrt(n) for one in (before, h * math.sqrt(n)))
    gain = (np.abs(H) ** 2).sum(axis=1)
    weight = np.full(len(gain), 2.0)
    weight[0] = 1.0
    if n % 2 == 0:
        weight[-1] = 1.0
    s, c, white = np.zeros(len(gain)), np.zeros(before.shape[2]), e
    for _ in range(ROUNDS):
        E = np.fft.rfft(e - before @ c, axis=0) / math.sqrt(n)
        s = _spectrum(gain, np.abs((np.conj(H) * E).sum(axis=1)) ** 2, weight)
        both, columns = (_whitened(one, H, gain, s, n) for one in (E[..., None], U))
        d = np.linalg.lstsq(columns.reshape(both.size, len(c)), both.ravel(), rcond=1e-9)[0]
        c, white = c + d, both[..., 0] - columns @ d
    white[~np.isfinite(found)] = np.nan
    left = float(scored(white))
    known = len({round(v, 12) for v in s[s > 0.0].tolist()})
    freedom = 0.5 * float(weight @ np.log1p(s * gain)) + PRICE * max(known - 1, 0)
    power = np.cumsum((weight * s)[1:])
    k = 1 + int(np.searchsorted(power, 0.5 * power[-1])) if power[-1] > 0.0 else 1
    return left + freedom, left, math.sqrt(float(weight @ s) / n), n / k


def _whitened(E: Complex, H: Complex, gain: Values, s: Values, n: int) -> Values:
    """Return S^(-1/2) E as series, (rows, signals, columns), of its coefficients E (frequencies, signals, columns)."""
    less = (1.0 - 1.0 / np.sqrt(1.0 + s * gain)) / np.maximum(gain, 1e-300)
    hit = np.einsum("fs,fsc->fc", np.conj(H), E) * less[:, None]
    found: Values = np.fft.irfft((E - H[:, :, None] * hit[:, None, :]) * math.sqrt(n), n, axis=0)
    return found


def earlier(h: Values) -> Values:
    """Return what loads before the first row can leave behind in the record, (rows, signals, shapes).

    It is what follows a row or more after a load, in as few shapes as the process has states.
    """
    n, signals = h.shape
    tails = np.stack([np.concatenate([h[j:], np.zeros((j, signals))]) for j in range(1, min(TAILS, n))], axis=-1)
    shapes, sizes, _ = np.linalg.svd(tails.reshape(n * signals, -1), full_matrices=False)
    kept = int((sizes > DISTINCT * max(sizes[0], 1e-300)).sum())
    found: Values = shapes[:, : min(kept, MOST)].reshape(n, signals, -1)
    return found


def forgotten(h: Values) -> bool:
    """Return whether a response (rows, signals) has died away before its last tenth, as Fourier series want it."""
    last = np.abs(h[-max(len(h) // 10, 1) :]).max(axis=0)
    return bool((last <= FORGOTTEN * np.abs(h).max(axis=0)).all())


def _spectrum(gain: Values, power: Values, weight: Values) -> Values:
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
