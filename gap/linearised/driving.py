"""What a log makes of the valves and planned sources before a process: simulated as they are, with whatever sticks."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from blocks.recorded import Recorded
from diagram.changes import part
from diagram.diagram import Diagram
from diagram.ensembles.running import ensemble
from diagram.playback import held
from gap.linearised.behind import Behind
from gap.linearised.between import BEFORE, line, moves
from gap.linearised.parts import Parts
from gap.records.record import Record
from logs import Log

Floats = NDArray[np.float64]
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
            found[s] = Recorded(s, *record.as_played(s), hold="previous")
        elif not moves(diagram, s):
            found[s] = held(logs[0], s) if len(logs) == 1 else [held(log, s) for log in logs]
        else:
            tables = [line(diagram, record, log, s) for log in logs]
            each = max(len(logs), len(more.more[s])) if s in more.more else len(logs)
            lines = [more.added(s, tables[min(i, len(tables) - 1)], i) for i in range(min(each, many))]
            found[s] = lines[0] if each == 1 else lines
    return found


def driven(
    diagram: Diagram, found: Parts, record: Record, logs: Sequence[Log], own: Mapping[str, Floats], many: int,
    more: Behind,
) -> Floats:  # fmt: skip
    """Return what logs make valves and planned sources give, (runs, 3, rows, inputs): at each row, just before it, and
    by how much the mean over the interval before it differs from that of a straight line.

    ``logs`` one a run, or one for all; ``own`` parameters of these blocks, one value a run; ``more`` what each run adds
    to a log between rows.
    """
    t = logs[0].t
    piece = part(diagram, found.fed, "fed")
    inside = [s for s in found.given if s in piece.signals]
    each = 2 + len(BETWEEN)
    gap = np.diff(t)[:, None]
    times = np.append(t[:-1, None] + gap * np.array([0.0, *BETWEEN, 1.0 - BEFORE]), t[-1])
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
            at, within = values[:, ::each], values[:, :-1].reshape(many, -1, each)
        else:
            table = as_inputs(diagram, record, logs, [s], more, many)[s]
            at = np.broadcast_to(np.stack([log[s] for log in logs]), (many, len(t)))
            within = np.broadcast_to(at[:, :-1, None], (many, len(t) - 1, each))
            lines = [table] if isinstance(table, tuple) else table
            if isinstance(lines, list) and isinstance(lines[0], tuple):
                seen = np.stack([np.interp(times[:-1], *one) for one in lines])
                within = np.broadcast_to(seen.reshape(len(lines), -1, each), within.shape)
        out[:, 0, :, j] = at
        out[:, 1, 0, j], out[:, 1, 1:, j] = at[:, 0], within[..., -1]
        out[:, 2, 1:, j] = within[..., 1:-1].mean(axis=-1) - 0.5 * (within[..., 0] + within[..., -1])
    return out
