"""The sums of ``regression`` and ``stems``, compiled: one line after another, so that its numbers stay at hand."""

import math
from typing import Any

import numpy as np
from stickslip.logs.compiled import njit

RIDGE = 1e-7  # of each column's square: columns that repeat each other must not stop the fit, in any unit
ROUNDING = 1e-12  # of a column's square before what is known is taken off it: less than that left is rounding


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def _solved(gram: Any, right: Any) -> None:
    """Solve gram b = right by Cholesky's factors, lower half given; b in place of ``right``."""
    p = len(right)
    for i in range(p):
        for j in range(i + 1):
            total = gram[i, j]
            for m in range(j):
                total -= gram[i, m] * gram[j, m]
            gram[i, j] = math.sqrt(max(total, 1e-300)) if i == j else total / gram[j, j]
        total = right[i]
        for m in range(i):
            total -= gram[i, m] * right[m]
        right[i] = total / gram[i, i]
    for i in range(p - 1, -1, -1):
        total = right[i]
        for m in range(i + 1, p):
            total -= gram[m, i] * right[m]
        right[i] = total / gram[i, i]


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def _product(x: Any, y: Any) -> float:
    total = 0.0
    for t in range(len(x)):
        total += x[t] * y[t]
    return total


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def climb(X: Any, y: Any, nu: float, floor: float, steps: int, w: Any, each: Any, b: Any) -> None:
    """Fit c lines X (c, n, p) to y (n,) from weights w (c, n), which change; log-likelihoods each (c, n), b (c, p)."""
    c, n, p = X.shape
    constant = math.lgamma(0.5 * (nu + 1.0)) - math.lgamma(0.5 * nu) - 0.5 * math.log(nu * math.pi)
    gram, left, x, weighed = np.empty((p, p)), np.empty(n), np.empty((p, n)), np.empty(n)
    for lane in range(c):
        squares = 0.0
        for i in range(p):
            for t in range(n):
                x[i, t] = X[lane, t, i]
        for _ in range(steps):
            for i in range(p):
                for t in range(n):
                    weighed[t] = w[lane, t] * x[i, t]
                b[lane, i] = _product(weighed, y)
                for j in range(i + 1):
                    gram[i, j] = _product(weighed, x[j])
            for i in range(p):
                gram[i, i] += RIDGE * gram[i, i] + 1e-300
            _solved(gram, b[lane])
            left[:] = y
            for i in range(p):
                for t in range(n):
                    left[t] -= x[i, t] * b[lane, i]
            squares = 0.0
            for t in range(n):
                squares += w[lane, t] * left[t] * left[t]
            squares = max(squares / n, floor * floor)
            for t in range(n):
                w[lane, t] = (nu + 1.0) / (nu + left[t] * left[t] / squares)
        for t in range(n):
            each[lane, t] = (
                constant - 0.5 * math.log(squares) - 0.5 * (nu + 1.0) * math.log1p(left[t] ** 2 / (nu * squares))
            )


@njit(cache=True, error_model="numpy", fastmath={"reassoc", "contract"})  # type: ignore[untyped-decorator]
def explained_by(inputs: Any, rows: Any, k: int, w: Any, q: Any, target: Any, left: Any) -> None:
    """Squares left (c,) of ``target`` (n,) by each of c ``inputs`` (c, m) of k to k + b - 1 rows ago.

    w (n,) roots of the weights, q (p, n) what is known beside the input, orthonormal; ``left`` (c, b): work and answer.
    """
    c, b = left.shape
    p, n = q.shape
    x = np.empty((b, n))
    along = np.empty((b, p))
    gram, cross, right = np.empty((b, b)), np.empty(b), np.empty(b)
    for lane in range(c):
        for i in range(b):
            for t in range(n):
                x[i, t] = w[t] * inputs[lane, rows[t] - k - i]
            cross[i] = _product(x[i], target)
            for j in range(i + 1):
                gram[i, j] = _product(x[i], x[j])
            for j in range(p):
                along[i, j] = _product(x[i], q[j])
            gram[i, i] += ROUNDING * gram[i, i]
        for i in range(b):
            for j in range(i + 1):
                total = gram[i, j]
                for m in range(p):
                    total -= along[i, m] * along[j, m]
                gram[i, j] = total
        for i in range(b):
            gram[i, i] += RIDGE * gram[i, i] + 1e-300
            right[i] = cross[i]
        _solved(gram, right)
        explained = 0.0
        for i in range(b):
            explained += cross[i] * right[i]
        left[lane, 0] = explained
