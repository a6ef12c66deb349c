"""Interval of a number that is worked out from means over half waves or cycles, by weighing them anew."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from stickslip.detect.signals.order import percentiles
from stickslip.logs.arrays import Values

DRAWN = 256  # half waves whose weights are drawn at least


def interval(
    of: Callable[[Values], Values], rows: Values, coverage: float = 0.90, resamples: int = 300, seed: int = 2005
) -> tuple[float, float]:
    """Return the interval (low, high) of an index that is made of means over ``rows`` (n, k).

    ``of`` gives the index of means (..., k); it is asked for many means, each with random weights of the rows.

    The same seed gives the same interval.  Source: Rubin 1981, Ann. Statist. 9:130 (the Bayesian bootstrap).

    >>> x = np.random.default_rng(0).normal(5.0, 1.0, (400, 1))
    >>> low, high = interval(lambda m: m[:, 0], x)
    >>> 4.85 < low < 5.0 < high < 5.15
    True
    """
    n = len(rows)
    weights = _drawn(max(DRAWN, 1 << (n - 1).bit_length()), resamples, seed)[:, :n]
    columns = np.ascontiguousarray(np.column_stack([rows, np.ones(n)]).T)
    *sums, total = (np.einsum("rn,n->r", weights, column) for column in columns)  # one by one: many times as quick
    means = np.stack(sums, axis=1) / total[:, None]
    tail = 0.5 * (1.0 - coverage)
    low, high = percentiles(of(means), 100.0 * tail, 100.0 * (1.0 - tail))
    return low, high


@lru_cache(maxsize=4)
def _drawn(n: int, resamples: int, seed: int) -> Values:
    """Weights (resamples, n), drawn once for all records of up to n half waves; a record takes the first of each."""
    return np.random.default_rng(seed).standard_exponential((resamples, n))
