"""What a log makes of the valves and planned sources before a process: simulated as they are, with whatever sticks."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.changes import part
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.diagram.playback import held
from stickslip.gap.linearised.behind import Behind
from stickslip.gap.linearised.between import BEFORE, line, moves
from stickslip.gap.linearised.parts import Parts
from stickslip.gap.records.record import Record
from stickslip.logs import Log
from stickslip.logs.arrays import Values

SAME = 1e-7  # of an interval: times so near to one another are one
BETWEEN = tuple((np.arange(8) + 0.5) / 8.0)  # shares of an interval at which a signal is looked at for its mean


def as_inputs(
    diagram: Diagram, record: Record, logs: Sequence[Log], signals: Sequence[str], more: Behind, many: int
) -> dict[str, Any]:
    """Return logged signals as inputs of so many runs, each of its own log or all of one; ``more`` what each run adds
    between rows.
    """
    found: dict[str, Any] = {}
    for s in signals:
        if s in record.played:
            found[s] = record.source(s)
        elif not moves(diagram, s):
            found[s] = held(logs[0], s) if len(logs) == 1 else [held(log, s) for log in logs]
        else:
            tables = [line(diagram, record, log, s) for log in logs]
            each = max(len(logs), len(more.more[s])) if s in more.more else len(logs)
            lines = [more.added(s, tables[min(i, len(tables) - 1)], i) for i in range(min(each, many))]
            found[s] = lines[0] if each == 1 else lines
    return found


def driven(
    diagram: Diagram, found: Parts, record: Record, logs: Sequence[Log], own: Mapping[str, Values], many: int,
    more: Behind,
) -> Values:  # fmt: skip
    """Return what logs make valves and planned sources give, (runs, 3, rows, inputs): at each row, just before it, and
    by how much the mean over the interval before it differs from that of a straight line.

    ``logs`` one a run, or one for all; ``own`` parameters of these blocks, one value a run; ``more`` what each run adds
    to a log between rows.
    """
    t = logs[0].t
    piece = part(diagram, found.fed, "fed")
    inside = [s for s in found.given if s in piece.signals]
    times = _times(t, more)
    rows = np.searchsorted(times, t)
    out = np.zeros((many, 3, len(t), len(found.given)))
    if inside:
        run = ensemble(
            piece, logs[0].duration, t0=float(t[0]), times=times, params=dict(own), seeds=np.zeros(many, dtype=int),
            inputs=as_inputs(diagram, record, logs, piece.open_inputs, more, many) or None, signals=inside,
            progress=False,
        )  # fmt: skip
    for j, s in enumerate(found.given):
        if s in inside:
            values = np.where(run.ok[:, None], run.values[s], np.nan)
        else:
            table = as_inputs(diagram, record, logs, [s], more, many)[s]
            lines = [table] if isinstance(table, tuple) else table
            if isinstance(lines, list) and isinstance(lines[0], tuple):
                values = np.stack([np.interp(times, *one) for one in lines])
                values[:, rows] = np.stack([log[s] for log in logs])
            else:
                held_values = np.stack([log[s] for log in logs])
                values = held_values[:, np.searchsorted(rows, np.arange(len(times)), side="right") - 1]
        at, before = values[:, rows], values[:, rows[1:] - 1]
        out[:, 0, :, j] = at
        out[:, 1, 0, j], out[:, 1, 1:, j] = at[:, 0], before
        out[:, 2, 1:, j] = _means(times, values, rows) - 0.5 * (at[:, :-1] + before)
    return out


def _times(t: Values, more: Behind) -> Values:
    """Return the rows' times [s] with those between them at which a signal is looked at: some in each interval, one
    just before each row, and all at which runs add something, such as just before and at a switch.
    """
    gap = np.diff(t)[:, None]
    own = np.append(t[:-1, None] + gap * np.array([0.0, *BETWEEN, 1.0 - BEFORE]), t[-1])
    extra = more.t[(more.t > own[0]) & (more.t < own[-1])]
    place = np.searchsorted(own, extra)
    apart = np.minimum(extra - own[place - 1], own[place] - extra)
    return np.sort(np.concatenate([own, extra[apart > SAME * float(gap.min())]]))


def _means(times: Values, values: Values, rows: NDArray[np.int64]) -> Values:
    """Return the mean of lines through values over the interval before each row but the first, (runs, rows - 1).

    >>> times = np.array([0.0, 0.5, 0.5 + 1e-9, 1.0, 2.0])  # a jump in the middle of the first interval
    >>> _means(times, np.array([[0.0, 0.0, 1.0, 1.0, 3.0]]), np.array([0, 3, 4])).round(6).tolist()
    [[0.5, 2.0]]
    """
    area = np.cumsum(0.5 * (values[:, 1:] + values[:, :-1]) * np.diff(times), axis=1)
    area = np.concatenate([np.zeros((len(values), 1)), area], axis=1)[:, rows]
    return np.asarray(np.diff(area, axis=1) / np.diff(times[rows]))
