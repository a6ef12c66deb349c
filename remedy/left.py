"""What is left of PV behind the answer to a stem: a line, an autoregression, and the spread of its errors.

    v = PV - K x,    v_t = c + d t + n_t,    n_t = sum_k a_k n_(t-k) + e_t,    s = spread of e

The a_k of rows long ago are the same within each of ``EDGES``: behind an integrator a load wanders far, and beside
white noise only a mean of many rows tells where it is.  With eight rows alone the gain came out too small.
Source: F. Corsi, J. Financial Econometrics 7 (2009) 174-196.  The sums over rows are compiled.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.compiled import njit
from stickslip.logs.normal import Z90

__all__ = [
    "Left", "excitation", "free_of_line", "left_of", "nugget", "paced", "past", "size", "turns_of", "wandering",
    "whitened",
]  # fmt: skip

EDGES = (1, 2, 3, 4, 6, 9, 14, 22, 34)  # rows back, between which the autoregression is the same
NUGGETS = 12  # parts of a record, whose noise tells how surely it is known
WAVES, NEAR, CLIP = 5, 0.06, 6.0  # waves at least; share of a pace; spreads of errors
NU, SHARE = 5.0, 0.6  # of Student's t: p(e) goes by (1 + e^2 / NU s^2)^-3; of the errors' variance, that is s^2
LEAST = 12  # rows of a record for each of its memory
FAST: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"reassoc", "contract"}}


@dataclass(frozen=True, eq=False)
class Left:
    """What is left of a day: v = a v_before + e, spread s of e; c and d, its level and slope by rows."""

    a: Values
    s: float
    c: float
    d: float


def left_of(v: Values, line: tuple[float, float], a: Values, share: float = 1.0) -> Left:
    """The noise of v (rows,) beside its ``line``, with memory a; ``share`` of the variance of its errors."""
    return Left(a, math.sqrt(share * size(whitened(v, a)) + 1e-300), *line)


def free_of_line(v: Values) -> tuple[Values, tuple[float, float]]:
    """v (rows,) without its line, and the line's level and slope."""
    time = np.arange(len(v)) - 0.5 * (len(v) - 1)
    slope = float(v @ time / (time @ time))
    level = float(v.mean())
    return v - level - slope * time, (level - slope * 0.5 * (len(v) - 1), slope)


def _beside_past(v: Values) -> Values:
    """Each row of v (rows,) and the means of the rows before it that share a coefficient, (rows - order, 1 + means)."""
    edges = _edges(len(v))
    order, sums = edges[-1] - 1, np.append(0.0, np.cumsum(v))
    ahead = [sums[order - i + 1 : len(sums) - i] for i in edges]  # up to the row that is i rows back
    means = [(one - two) / (j - i) for one, two, i, j in zip(ahead, ahead[1:], edges, edges[1:], strict=False)]
    return np.column_stack([v[order:], *means])


@lru_cache(maxsize=32)
def _edges(rows: int) -> tuple[int, ...]:
    """The ``EDGES`` that so many rows allow."""
    return tuple(edge for edge in EDGES if edge <= max(rows // LEAST, EDGES[4]))


def past(v: Values) -> Values:
    """The autoregression of v (rows,), (order,), by least squares."""
    seen, edges = _beside_past(v), _edges(len(v))
    gram = seen.T @ seen
    b = _solved(gram[1:, 1:], gram[0, 1:])
    return np.concatenate([np.full(j - i, one / (j - i)) for one, i, j in zip(b, edges, edges[1:], strict=False)])


def _solved(gram: Values, right: Values) -> Values:
    """The solution of least squares for gram (k, k) and right (k,), with a little for what stands."""
    return np.asarray(np.linalg.solve(gram + (1e-9 * np.trace(gram) / len(gram) + 1e-300) * np.eye(len(gram)), right))


def excitation(y: Values, x: Values) -> float:
    """What the past of x (rows,) tells of y beyond y's own past [nats], less ln(n)/2 for each of its coefficients."""
    if np.ptp(x) <= 1e-9:
        return 0.0
    own, other = _beside_past(y), _beside_past(x)[:, 1:]
    both = np.concatenate([own, other - other.mean(axis=0)], axis=1)
    gram = both.T @ both
    left = [
        gram[0, 0] - gram[0, 1:k] @ _solved(gram[1:k, 1:k], gram[0, 1:k]) for k in (own.shape[1], len(gram))
    ]  # fmt: skip
    return float(0.5 * len(own) * math.log(left[0] / left[1]) - 0.5 * other.shape[1] * math.log(len(own)))


def paced(v: Values) -> float:
    """What the errors of v (rows,) in all other waves tell of one wave, if waves come at a steady pace [nats].

        v_t = sum_k a_k v_(t-k) + sum_k b_k m_(t+k) + e_t,   m_t the mean error at the phase of t in the other waves

    less ln(n)/2 for the pace and each b; the pace is where v is most like itself again, made better within ``NEAR``.
    """
    seen = _beside_past(v)
    y, own = seen[:, 0], seen[:, 1:]
    n, z = len(y), y - y.mean()
    alike = np.fft.irfft(np.abs(np.fft.rfft(z, 2 * n)) ** 2)[: n // WAVES] / np.arange(n, n - n // WAVES, -1)
    first = int(np.argmax(alike < 0.0))
    if first < 2:
        return 0.0
    rows = first + int(np.argmax(alike[first:]))
    e, plain = _left_by(y, own)
    e = np.clip(e, -CLIP * math.sqrt(size(e)), CLIP * math.sqrt(size(e)))

    def others(of: Values, pace: float) -> Values:
        at = (np.arange(n) % pace).astype(int)
        return np.asarray((np.bincount(at, of)[at] - of) / np.maximum(np.bincount(at)[at] - 1, 1))

    smooth = np.convolve(e, [1.0] * 3, "same")
    paces = rows * (1.0 + np.linspace(-NEAR, NEAR, min(1 + 15 * n // rows, 400)))
    pace = max(paces, key=lambda each: float(others(smooth, each) @ smooth))
    waves = [np.roll(others(e, pace), k) for k in range(-2, 3)]
    return _left_by(y, np.column_stack([own, *waves]))[1] - plain - 0.5 * (len(waves) + 1) * math.log(n)


def _left_by(y: Values, X: Values) -> tuple[Values, float]:
    """What X (rows, k) leaves of y (rows,) where errors are Student's t, and their likelihood [nats]."""
    weighed = X
    for _ in range(3):
        e = y - X @ _solved(weighed.T @ X, weighed.T @ y)
        s = SHARE * size(e) + 1e-300
        weighed = X / (1.0 + e**2 / (NU * s))[:, None]
    return e, -0.5 * (NU + 1.0) * float(np.log1p(e**2 / (NU * s)).sum()) - 0.5 * len(e) * math.log(s)


def nugget(v: Values) -> Values:
    """The variance of white noise on v (rows,), (3,): least, likeliest, most, with what sampling leaves unsure (90 %).

        E (v_(t+k) - v_t)^2 = 2 noise + c k^p,    p = 1 for what wanders, 2 for what is smooth

    p follows from k = 1, 2 and 4, and the other two are the ends.  Source: the nugget of a variogram (Cressie,
    Statistics for Spatial Data, 1993, section 2.4).
    """
    ways = [[size(block[k:] - block[:-k]) for block in np.array_split(v, NUGGETS)] for k in (1, 2, 4)]
    one, two, four = np.array(ways)
    grown = (four.mean() - two.mean()) / max(two.mean() - one.mean(), 1e-300)
    found = [0.5 * (one - (two - one) / (rise - 1.0)) for rise in (2.0, min(max(grown, 2.0), 4.0), 4.0)]
    unsure = [float(np.std(each, ddof=1)) / math.sqrt(NUGGETS) for each in found]
    return np.asarray(np.mean(found, axis=1) + np.array([-Z90, 0.0, Z90]) * unsure)


def wandering(v: Values, roots: int) -> Values:
    """An autoregression of v that wanders: of its differences, taken ``roots`` times, with as many roots at 1.

    PV is held by the controller, what the load leaves without it is not: the memory of PV would be too short for it.
    Behind an integrator the load wanders twice: with one root, a stem that makes up for it seems to have no gain.
    """
    a = past(np.diff(v, roots))
    for _ in range(roots):
        a = np.append(a, 0.0) + np.append(1.0, -a)
    return np.asarray(a)


@njit(**FAST)  # type: ignore[untyped-decorator]
def turns_of(a: Any) -> Any:
    """Where the autoregression a turns to another value [rows], and by how much: sum a_k v_(t-k) = sum turn V_(t-lag).

    V_t is the sum of v to its row t: most of these terms are zero.
    """
    padded = np.zeros(len(a) + 2)
    padded[1:-1] = a
    lags = np.flatnonzero(padded[1:] - padded[:-1]) + 1
    return lags, padded[lags] - padded[lags - 1]


@njit(**FAST)  # type: ignore[untyped-decorator]
def whitened(v: Any, a: Any) -> Any:
    """One-step errors of v (rows,), without its first rows."""
    p = len(a)
    found, sums = v[p:].copy(), np.zeros(len(v) + 1)
    for t in range(len(v)):
        sums[t + 1] = sums[t] + v[t]
    lags, turns = turns_of(a)
    for j in range(len(lags)):
        for t in range(len(found)):
            found[t] -= turns[j] * sums[p + 1 - lags[j] + t]
    return found


@njit(**FAST)  # type: ignore[untyped-decorator]
def size(e: Any) -> float:
    """Variance of errors of which the largest do not count in full."""
    most = 4.0 * np.median(np.abs(e)) + 1e-300
    total = 0.0
    for each in e:
        total += min(abs(each), most) ** 2
    return float(total / len(e))
