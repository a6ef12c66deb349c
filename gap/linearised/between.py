"""What logged signals do between two rows, as inputs of what they drive.

a signal that a block makes all the time    goes along straight lines; where a set point jumps at a row, what follows
                                            from it goes on as before until then, and jumps too
a set point, the output of a scan           keeps its value until the next row
"""

import numpy as np
from numpy.typing import NDArray

from blocks.role import Role
from diagram.diagram import Diagram
from diagram.playback import held
from gap.linearised.parts import ancestors
from gap.record import Record
from logs import Log

Floats = NDArray[np.float64]
BEFORE = 1e-6  # of an interval: how long before a row the value is taken that holds until it
RARE = 0.1  # share of rows at which a set point jumps, at most
SHORTEST = 30  # rows of a stretch


def as_input(diagram: Diagram, record: Record, log: Log, signal: str) -> object:
    """Return a logged signal as an input of a run."""
    if not moves(diagram, signal):
        return held(log, signal)
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
            moved = np.diff(log[s]) != 0.0
            if moved.mean() < RARE:
                found[1:] |= moved
    return found


def joined(log: Log, signal: str, at: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Return times [s] and values of a signal, joined by straight lines except before rows at which it jumps.

    >>> log = Log([0.0, 1.0, 2.0, 3.0], {"OP": [0.0, 0.1, 0.8, 0.9]})
    >>> t, values = joined(log, "OP", np.array([False, False, True, False]))
    >>> t.round(3).tolist(), values.round(3).tolist()
    ([0.0, 1.0, 2.0, 2.0, 3.0], [0.0, 0.1, 0.2, 0.8, 0.9])
    """
    good = log.good(signal)
    t, v, jump = log.t[good], log[signal][good], np.flatnonzero(at[good])
    jump = jump[jump >= 2]
    before = 2.0 * v[jump - 1] - v[jump - 2]
    return np.insert(t, jump, t[jump] - BEFORE * (t[jump] - t[jump - 1])), np.insert(v, jump, before)


def until(t: Floats, table: tuple[Floats, Floats]) -> Floats:
    """Return what a joined signal is just before each time (first: at it), (rows,)."""
    early = t.copy()
    early[1:] -= BEFORE * np.diff(t)
    return np.asarray(np.interp(early, *table))


def stretches(values: Floats, unit: Floats) -> list[tuple[int, int]]:
    """Return the first row of each stretch and the one behind it: a new one begins where a signal has moved.

    ``values`` (rows, signals); ``unit`` by how much each may differ from where its stretch began.

    >>> stretches(np.array([[0.0]] * 40 + [[3.0]] * 40), np.array([1.0]))
    [(0, 40), (40, 80)]
    """
    begins = [0]
    for k in range(1, len(values)):
        away = np.abs(values[k] - values[begins[-1]]) / unit
        if k - begins[-1] >= SHORTEST and np.nanmax(away, initial=0.0) > 1.0:
            begins.append(k)
    return list(zip(begins, [*begins[1:], len(values)], strict=True))
