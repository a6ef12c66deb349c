"""What a log makes of the valves and planned sources before a process: simulated as they are, with whatever sticks."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from diagram.changes import part
from diagram.diagram import Diagram
from diagram.ensembles.running import ensemble
from gap.linearised.between import BEFORE, as_input
from gap.linearised.parts import Parts
from gap.record import Record
from logs import Log

Floats = NDArray[np.float64]
BETWEEN = (0.125, 0.375, 0.625, 0.875)  # shares of an interval at which a signal is looked at for its mean


def driven(diagram: Diagram, found: Parts, record: Record, log: Log, own: Mapping[str, Floats], many: int) -> Floats:
    """Return what a log makes valves and planned sources give, (runs, 3, rows, inputs): at each row, just before it,
    and by how much the mean over the interval before it differs from that of a straight line.

    ``own`` parameters of these blocks, one value a run.
    """
    piece = part(diagram, found.fed, "fed")
    inside = [s for s in found.given if s in piece.signals]
    each = 2 + len(BETWEEN)
    gap = np.diff(log.t)[:, None]
    times = np.append(log.t[:-1, None] + gap * np.array([0.0, *BETWEEN, 1.0 - BEFORE]), log.t[-1])
    out = np.zeros((many, 3, len(log), len(found.given)))
    if inside:
        run = ensemble(
            piece, log.duration, t0=float(log.t[0]), times=times, params=dict(own), seeds=np.zeros(many, dtype=int),
            inputs={s: as_input(diagram, record, log, s) for s in piece.open_inputs} or None, signals=inside,
            progress=False,
        )  # fmt: skip
    for j, s in enumerate(found.given):
        if s in inside:
            values = np.where(run.ok[:, None], run.values[s], np.nan)
            at, within = values[:, ::each], values[:, :-1].reshape(many, -1, each)
        else:
            table = as_input(diagram, record, log, s)
            at = np.broadcast_to(log[s], (many, len(log)))
            within = np.broadcast_to(at[:, :-1, None], (many, len(log) - 1, each))
            if isinstance(table, tuple):
                within = np.broadcast_to(np.interp(times[:-1], *table).reshape(1, -1, each), within.shape)
        out[:, 0, :, j] = at
        out[:, 1, 0, j], out[:, 1, 1:, j] = at[:, 0], within[..., -1]
        out[:, 2, 1:, j] = within[..., 1:-1].mean(axis=-1) - 0.5 * (within[..., 0] + within[..., -1])
    return out
