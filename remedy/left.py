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
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.compiled import njit

__all__ = ["Left", "free_of_line", "left_of", "past", "size", "turns_of", "wandering", "whitened"]

Floats = NDArray[np.float64]
EDGES = (1, 2, 3, 4, 6, 9, 14, 22, 34)  # rows back, between which the autoregression is the same
LEAST = 12  # rows of a record for each of its memory
FAST: dict[str, Any] = {"cache": True, "error_model": "numpy", "fastmath": {"reassoc", "contract"}}


@dataclass(frozen=True, eq=False)
class Left:
    """What is left of a day: v = a v_before + e, spread s of e; c and d, its level and slope by rows."""

    a: Floats
    s: float
    c: float
    d: float


def left_of(v: Floats, line: tuple[float, float], a: Floats, share: float = 1.0) -> Left:
    """The noise of v (rows,) beside its ``line``, with memory a; ``share`` of the variance of its errors."""
    return Left(a, math.sqrt(share * size(whitened(v, a)) + 1e-300), *line)


def free_of_line(v: Floats) -> tuple[Floats, tuple[float, float]]:
    """v (rows,) without its line, and the line's level and slope."""
    time = np.arange(len(v)) - 0.5 * (len(v) - 1)
    slope = float(v @ time / (time @ time))
    level = float(v.mean())
    return v - level - slope * time, (level - slope * 0.5 * (len(v) - 1), slope)


@lru_cache(maxsize=32)
def _means(rows: int) -> Floats:
    """Means over rows back, (order, means), as far as so many rows allow."""
    edges = [edge for edge in EDGES if edge <= max(rows // LEAST, EDGES[4])]
    found = np.zeros((edges[-1] - 1, len(edges) - 1))
    for j, (first, after) in enumerate(pairwise(edges)):
        found[first - 1 : after - 1, j] = 1.0 / (after - first)
    return found


def past(v: Floats) -> Floats:
    """The autoregression of v (rows,), (order,), by least squares."""
    means = _means(len(v))
    order, count = means.shape
    gram = _products(v, order)
    right, gram = means.T @ gram[0, 1:], means.T @ gram[1:, 1:] @ means
    gram[range(count), range(count)] += 1e-9 * np.trace(gram) / count + 1e-300
    return np.asarray(means @ np.linalg.solve(gram, right))


def wandering(v: Floats, roots: int) -> Floats:
    """An autoregression of v that wanders: of its differences, taken ``roots`` times, with as many roots at 1.

    PV is held by the controller, what the load leaves without it is not: the memory of PV would be too short for it.
    Behind an integrator the load wanders twice: with one root, a stem that makes up for it seems to have no gain.
    """
    a = past(np.diff(v, roots))
    for _ in range(roots):
        a = np.append(a, 0.0) + np.append(1.0, -a)
    return np.asarray(a)


@njit(**FAST)  # type: ignore[untyped-decorator]
def _products(v: Any, order: int) -> Any:
    """Sums of v_(t-i) v_(t-j) for i, j = 0 .. order over all rows t >= order."""
    n = len(v)
    gram = np.empty((order + 1, order + 1))
    for j in range(order + 1):
        total = 0.0
        for t in range(order, n):
            total += v[t] * v[t - j]
        gram[0, j] = gram[j, 0] = total
    for i in range(order):
        for j in range(i, order):  # one row earlier: a row comes in and one goes out
            total = gram[i, j] + v[order - 1 - i] * v[order - 1 - j] - v[n - 1 - i] * v[n - 1 - j]
            gram[i + 1, j + 1] = gram[j + 1, i + 1] = total
    return gram


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
