"""Straight lines through rows whose errors have heavy tails: the log-likelihood under Student's t, many lines at once.

    y = X b + s e,   e Student t of nu degrees of freedom
    w = (nu + 1) / (nu + (r / s)^2),   b = least squares with weights w,   s^2 = mean(w r^2),   again

A few steps of this climb to the largest likelihood (Lange, Little and Taylor 1989, J. Am. Stat. Assoc. 84:881).
"""

from typing import NamedTuple

import numpy as np
from stickslip.logs.arrays import Values

STEPS = 8


class Lines(NamedTuple):
    """c lines through n rows: each (c, n) log-likelihood of every row [nats]; b (c, p); w (c, n) weights [-]."""

    each: Values
    b: Values
    w: Values

    @property
    def total(self) -> Values:
        """Log-likelihood of every line, (c,) [nats]."""
        return np.asarray(self.each.sum(axis=1))


def lines(X: Values, y: Values, nu: float, floor: float, steps: int = STEPS, w: Values | None = None) -> Lines:
    """Fit c lines, X (c, n, p), to y (n,); ``floor`` [unit of y] is the least s, ``w`` (n,) weights to start from.

    >>> x = np.linspace(-1, 1, 50)
    >>> found = lines(np.stack([np.ones(50), x], axis=1)[None], 2 + 3 * x, 5.0, 0.01)
    >>> found.b.round(3).tolist()
    [[2.0, 3.0]]
    """
    from stickslip.detect.likelihood.kernels import climb

    c, n, p = X.shape
    weights = np.ones((c, n)) if w is None else np.tile(w, (c, 1))
    each, b = np.empty((c, n)), np.empty((c, p))
    climb(np.ascontiguousarray(X), np.ascontiguousarray(y), nu, floor, steps, weights, each, b)
    return Lines(each, b, weights)
