"""The gains of one filter for another, whose states are not all the same: what only one has is not set right."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from stickslip.logs.arrays import Values


class Labels(NamedTuple):
    """Names of the ``states`` of a filter, and of what holds each of its ``noises``."""

    states: Sequence[str]
    noises: Sequence[str]


def gains_for(mine: Labels, theirs: Labels, gains: Values) -> Values:
    """Return gains, (rows, 2 n + m + q + 1, m) (see ``extended``), of a filter for another."""
    if mine.states == theirs.states:
        return gains
    n, m, k = len(mine.states), gains.shape[2], len(theirs.states)
    both = [(i, theirs.states.index(name)) for i, name in enumerate(mine.states) if name in theirs.states]
    here, there = (np.array(side, dtype=np.int64) for side in zip(*both, strict=True))
    found = np.zeros((len(gains), 2 * n + m + len(mine.noises) + 1, m))
    found[:, here], found[:, n : n + m] = gains[:, there], gains[:, k : k + m]
    found[:, n + m + here] = gains[:, k + m + there]
    for j, name in enumerate(mine.noises):
        if name in theirs.noises:
            found[:, 2 * n + m + j] = gains[:, 2 * k + m + theirs.noises.index(name)]
    return found


def turns_for(mine: Labels, theirs: Labels, turns: Values) -> Values:
    """Return what bends add to the mean at each stop, (stops, n + m), likewise."""
    if mine.states == theirs.states:
        return turns
    n, k = len(mine.states), len(theirs.states)
    found = np.zeros((len(turns), n + turns.shape[1] - k))
    for i, name in enumerate(mine.states):
        if name in theirs.states:
            found[:, i] = turns[:, theirs.states.index(name)]
    found[:, n:] = turns[:, k:]
    return found
