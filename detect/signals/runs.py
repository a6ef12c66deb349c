"""Runs in a signal: where something holds sample after sample, and where a signal stands."""

import numpy as np
from stickslip.logs.arrays import Indices, Mask, Values


def runs(x: Mask) -> tuple[Indices, Indices]:
    """First sample of every run of True in x (n,), and the one behind its last, both (m,).

    >>> [each.tolist() for each in runs(np.array([True, False, True, True]))]
    [[0, 2], [1, 4]]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[0], x.astype(np.int8), [0]])))
    return edges[::2], edges[1::2]


def stands(x: Values) -> tuple[Indices, Indices]:
    """First sample and length of every run of equal values in x (n,), n >= 1, both (m,).

    >>> [each.tolist() for each in stands(np.array([4.0, 4.0, 5.0]))]
    [[0, 2], [2, 1]]
    """
    first = np.concatenate([[0], np.flatnonzero(x[1:] != x[:-1]) + 1])
    return first, np.diff(first, append=len(x))
