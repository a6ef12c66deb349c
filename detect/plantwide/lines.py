"""Which tags share an oscillation: each tag's strongest spectral line, and the tags that have power at it.

    x less its straight line, under a Hann window, zero-padded four times  ->  power P(f)
    share(f) = sum of P over the main lobe about f / sum of P          [-]
    a line     the largest P with at least three cycles in the log, if its share is ``LINE_SHARE`` or more
    a group    the line that holds most of the tags still without a group, and the tags with ``COMMON_SHARE`` or more
               there, if the autocorrelation of one of its ``TRIED`` strongest tags is regular at that period

The last rule keeps noise out: a random walk, too, has a strongest line.

Source of the idea: Thornhill, Shah, Huang and Vishnubhotla 2002, Control Eng. Practice 10:1353 (tags are grouped by
their power spectra); the rule here is the plain one of a common peak (Jiang, Choudhury and Shah 2007 look for it in the
spectral envelope).  Both limits are ours.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from stickslip.detect.oscillation import acf_crossings
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Indices, Values

CYCLES_MIN = 3.0  # fewest in the log: below, a drift is as good an answer
LINE_SHARE = 0.30  # of the variance, that a tag's own line must hold
COMMON_SHARE = 0.25  # of the variance, that a tag of the group must have at the common line
TRIED = 5  # tags of a group that may confirm it
PERIOD_OFF_SHARE = 0.15  # relative: how far the period of the autocorrelation may lie from the line's
PAD = 4


class Spectra(NamedTuple):
    """Power (tags, m) at the frequencies f (m,) [1/s] with a sum of 1 for each tag; ``lobe`` half width in steps.

    t (n,) [s] and rows (tags, n) are what they were made of: straight lines off, standard deviation 1.
    """

    t: Values
    rows: Values
    tags: tuple[str, ...]
    f: Values
    power: Values
    lobe: int

    def share(self, k: int) -> Values:
        """Share of each tag's variance in the main lobe about frequency number k, shape (tags,)."""
        return np.asarray(self.power[:, max(k - self.lobe, 0) : k + self.lobe + 1].sum(axis=1))


class Together(NamedTuple):
    """A line that several tags share: period [s], share [-] of each tag's variance at it."""

    period: float
    shares: Mapping[str, float]


def spectra(t: Values, signals: Mapping[str, Values]) -> Spectra:
    """The spectra of the tags that move, on an even grid t (n,) [s]; values (n,) each.

    >>> t = np.arange(400.0)
    >>> found = spectra(t, {"a": np.sin(t / 5), "still": 0 * t})
    >>> found.tags, round(float(found.share(51)[0]), 2)  # 4 * 400 / (10 pi) = 51
    (('a',), 1.0)
    """
    n, dt = len(t), float(t[1] - t[0])
    centred = t - np.mean(t)
    rows, kept = [], []
    for tag, x in signals.items():
        y = x - np.mean(x)
        y = y - centred * float(centred @ y) / float(centred @ centred)
        if float(np.std(y)) > 1e-9 * float(np.max(np.abs(x))):
            rows.append(y / np.std(y))
            kept.append(tag)
    size, waves = PAD * n, np.array(rows).reshape(len(rows), n)
    power = np.abs(np.fft.rfft(waves * np.hanning(n), size)) ** 2
    power[:, :PAD] = 0.0  # less than one cycle in the log
    power /= np.maximum(power.sum(axis=1, keepdims=True), 1e-300)
    return Spectra(t, waves, tuple(kept), np.asarray(np.fft.rfftfreq(size, dt), dtype=np.float64), power, 2 * PAD)


def groups(found: Spectra) -> list[Together]:
    """The groups, the one with most tags first; a tag belongs to one, and a group has two tags or more.

    >>> t = np.arange(600.0)
    >>> signals = {"a": np.sin(t / 5), "b": np.cos(t / 5) + 1, "c": np.sin(t / 13), "d": np.sin(t / 13 + 1)}
    >>> [(round(one.period), tuple(one.shares)) for one in groups(spectra(t, signals))]
    [(31, ('b', 'a')), (82, ('c', 'd'))]
    """
    first = math.ceil(CYCLES_MIN * PAD)
    if not found.tags or found.power.shape[1] <= first + 1:
        return []
    peaks = first + np.argmax(found.power[:, first:], axis=1)
    own = np.array([found.share(int(k))[i] for i, k in enumerate(peaks)])
    free = np.ones(len(found.tags), dtype=bool)
    together: list[Together] = []
    while True:
        lines = [int(k) for i, k in enumerate(peaks) if free[i] and own[i] >= LINE_SHARE]
        if not lines:
            break
        k = max(lines, key=lambda line: float(np.sum(found.share(line)[free])))
        shares = found.share(k)
        joined = free & (shares >= COMMON_SHARE)
        free &= ~joined
        if joined.sum() > 1 and _regular(found, np.flatnonzero(joined), shares, 1.0 / float(found.f[k])):
            names = [(tag, float(s)) for tag, s, here in zip(found.tags, shares, joined, strict=True) if here]
            period = _period(found, found.power[joined].sum(axis=0), k)
            together.append(Together(period, dict(sorted(names, key=lambda pair: -pair[1]))))
    return sorted(together, key=lambda one: -len(one.shares))


def _period(found: Spectra, power: Values, k: int) -> float:
    """Period [s] at the top of the power (m,) about frequency number k, by a parabola through the logarithms there."""
    low = max(k - found.lobe, 1)
    top = low + int(np.argmax(power[low : k + found.lobe + 1]))
    a, b, c = np.log(np.maximum(power[top - 1 : top + 2], 1e-300)) if top + 1 < len(power) else (0.0, 1.0, 0.0)
    bend = a - 2.0 * b + c
    aside = 0.5 * (a - c) / bend if bend < 0.0 else 0.0
    return 1.0 / float(found.f[1] * (top + min(max(aside, -0.5), 0.5)))


def _regular(found: Spectra, joined: Indices, shares: Values, period: float) -> bool:
    """Whether one of the strongest tags of a group oscillates at its period by its autocorrelation."""
    for i in sorted(joined.tolist(), key=lambda i: -float(shares[i]))[:TRIED]:
        x = found.rows[i]
        gate = acf_crossings.find(LoopRecord.from_arrays(found.t, pv=x, op=x))
        if gate.oscillating and gate.period and abs(gate.period / period - 1.0) < PERIOD_OFF_SHARE:
            return True
    return False
