"""What logged signals do between two rows, as inputs of what they drive.

a signal that a block makes all the time    goes smoothly; where a set point jumps at a row, what follows from it goes
                                            on as before until then, and jumps too
a set point, the output of a scan           keeps its value until the next row
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.linearised.parts import ancestors
from stickslip.gap.records.record import Record, switches
from stickslip.logs import Log
from stickslip.logs.arrays import Values

BEFORE = 1e-6  # of an interval: how long before a row the value is taken that holds until it


def line(diagram: Diagram, record: Record, log: Log, signal: str) -> tuple[Values, Values]:
    """Return times [s] and values of the line along which a signal that changes all the time goes from row to row."""
    return joined(log, signal, jumps(diagram, record, log, signal))


def moves(diagram: Diagram, signal: str) -> bool:
    """Return whether a signal changes all the time: its block neither scans nor is a source."""
    if signal not in diagram.driven:
        return False
    block = diagram.blocks[diagram.driven[signal][0]]
    return not block.sampled and block.role is not Role.SOURCE


def jumps(diagram: Diagram, record: Record, log: Log, signal: str) -> NDArray[np.bool_]:
    """Return the rows at which a controller's output jumps, since a set point behind it does, (rows,)."""
    found = np.zeros(len(log), dtype=bool)
    if diagram.blocks[diagram.driven[signal][0]].role is Role.CONTROLLER:
        stop = {s for s in record.pinned if diagram.blocks[diagram.driven[s][0]].role is not Role.CONTROLLER}
        read = {str(s) for name in ancestors(diagram, [signal], stop) for s in diagram[name].input_labels}
        for s in read & set(record.played):
            if switches(log, s):
                found[1:] |= np.diff(log[s]) != 0.0
    return found


def joined(log: Log, signal: str, at: NDArray[np.bool_]) -> tuple[Values, Values]:
    """Return times [s] and values of a signal that goes smoothly from row to row except before rows at which it jumps.

    Between two rows stands a point of the parabolas through them and their neighbours on the same side of a jump.

    >>> log = Log([0.0, 1.0, 2.0, 3.0, 4.0], {"OP": [0.0, 0.1, 0.8, 0.9, 1.0]})
    >>> t, values = joined(log, "OP", np.array([False, False, True, False, False]))
    >>> t.round(3).tolist(), values.round(3).tolist()
    ([0.0, 0.5, 1.0, 1.5, 2.0, 2.0, 2.5, 3.0, 3.5, 4.0], [0.0, 0.05, 0.1, 0.15, 0.2, 0.8, 0.85, 0.9, 0.95, 1.0])
    """
    good = log.good(signal)
    t, v, jump = log.t[good], log[signal][good], np.flatnonzero(at[good])
    jump = jump[jump >= 2]
    before = 2.0 * v[jump - 1] - v[jump - 2]
    t = np.insert(t, jump, t[jump] - BEFORE * (t[jump] - t[jump - 1]))
    v = np.insert(v, jump, before)
    cut = jump + np.arange(len(jump))  # the points just before a jump
    bent = bends(v, cut)
    behind = np.setdiff1d(np.arange(1, len(t)), cut + 1)  # between a point just before a jump and the jump is nothing
    middle = 0.5 * (v[behind - 1] + v[behind]) - bent[behind - 1] / 8.0
    return np.insert(t, behind, 0.5 * (t[behind - 1] + t[behind])), np.insert(v, behind, middle)


def bends(v: Values, cut: NDArray[np.int64]) -> Values:
    """Return the second difference of values in each interval, from its neighbours between two of the points ``cut``.

    >>> bends(np.array([0.0, 1.0, 4.0, 9.0, 0.0, 0.0, 0.0]), np.array([3])).tolist()
    [2.0, 2.0, 2.0, 0.0, 0.0, 0.0]
    """
    out = np.zeros(max(len(v) - 1, 0))
    ends = [-1, *cut.tolist(), len(v) - 1]
    for first, last in pairwise(ends):
        second = np.diff(v[first + 1 : last + 1], 2)
        if len(second) > 1:
            ahead, behind = 1.5 * second[0] - 0.5 * second[1], 1.5 * second[-1] - 0.5 * second[-2]
            out[first + 1 : last] = np.concatenate([[ahead], 0.5 * (second[1:] + second[:-1]), [behind]])
        elif len(second):
            out[first + 1 : last] = second[0]
    return out


def until(t: Values, table: tuple[Values, Values]) -> Values:
    """Return what a joined signal is just before each time (first: at it), (rows,)."""
    early = t.copy()
    early[1:] -= BEFORE * np.diff(t)
    return np.asarray(np.interp(early, *table))
