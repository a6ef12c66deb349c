"""Least squares with weights that are not negative, from the normal equations: G w = b but for what would fall below 0.

    w >= 0,   g = b - G w <= 0,   w_i g_i = 0        (Karush, Kuhn and Tucker)

Source: Lawson and Hanson, Solving least squares problems, 1974; of the normal equations Bro and de Jong 1997.  SciPy's
takes a quarter of a second to load, a tenth of a whole answer.
"""

import numpy as np
from stickslip.logs.arrays import Mask, Values

ROUNDING = 1e-13  # of the largest b: a smaller slope is none


def nonnegative(gram: Values, product: Values, like: Values | None = None) -> Values:
    """The weights (p,) of least w'Gw / 2 - b'w for G ``gram`` (p, p), positive definite, and b ``product`` (p,).

    ``like`` : weights (p,) of a problem like this one, to begin with those that are free there; the answer is the same

    >>> nonnegative(np.eye(2), np.array([1.0, -1.0])).tolist()
    [1.0, 0.0]
    """
    weights = np.zeros(len(product))
    free = np.zeros(len(product), dtype=bool) if like is None else like > 0.0
    least = ROUNDING * float(np.max(np.abs(product), initial=0.0))
    for _ in range(3 * len(product)):
        weights = _inside(gram, product, free, weights)
        slope = np.where(free, -np.inf, product - gram @ weights)
        best = int(np.argmax(slope))
        if not slope[best] > least:
            break
        free[best] = True
    return weights


def _inside(gram: Values, product: Values, free: Mask, weights: Values) -> Values:
    """The best weights of those that are free, from ``weights`` on; one that would fall below 0 is free no longer."""
    while True:
        at = np.flatnonzero(free)
        found = np.zeros_like(weights)
        found[at] = np.linalg.solve(gram[at[:, None], at], product[at])
        below = at[found[at] <= 0.0]
        if not len(below):
            return found
        down = weights[below] - found[below]
        shares = np.divide(weights[below], down, out=np.zeros_like(down), where=down > 0.0)
        weights = weights + np.min(shares) * (found - weights)
        free[below[shares <= np.min(shares)]] = False
        weights[~free] = 0.0
