"""How logged signals move between the rows after a switch of a set point, where no smooth line through the rows shows
it.

A controller's output jumps there, a pressure follows within a fraction of an interval.  A run of the model itself, with
the record's set points and without noise, shows both; what it does beyond the line through its own rows is added to
the line through the log's.  A run of a model with an effect shows what that makes of it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.gap.linearised.between import BEFORE, line, moves
from stickslip.gap.null_model.null_model import EXACT
from stickslip.gap.records.record import Record, switch_rows, switches
from stickslip.logs import Log
from stickslip.logs.arrays import Values

SAME = 1e-9  # [s] between times that are one
ROWS = 15  # behind a switch for which signals are looked at
SHARES = (0.015, 0.03, 0.06, 0.125, 0.1875, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)  # of an interval: where


@dataclass(frozen=True, eq=False)
class Behind:
    """At the times ``t`` [s] what is added to each signal, ``more`` (runs or 1, times)."""

    t: Values
    more: Mapping[str, Values]

    @property
    def runs(self) -> int:
        """How many runs there are."""
        return max((len(v) for v in self.more.values()), default=1)

    def added(self, signal: str, table: tuple[Values, Values], run: int) -> tuple[Values, Values]:
        """Return times [s] and values of a signal that goes along a table's lines, with what a run adds to them."""
        if signal not in self.more:
            return table
        t, v = table
        more = self.more[signal][min(run, len(self.more[signal]) - 1)]
        place = np.clip(np.searchsorted(t, self.t), 1, len(t) - 1)
        new = np.minimum(np.abs(t[place] - self.t), np.abs(t[place - 1] - self.t)) > SAME
        both = np.concatenate([t, self.t[new]])
        there = v + np.interp(t, self.t, more, left=0.0, right=0.0)
        values = np.concatenate([there, np.interp(self.t[new], t, v) + more[new]])
        order = np.argsort(both, kind="stable")
        return both[order], values[order]


NOTHING = Behind(np.zeros(0), {})


def behind(diagram: Diagram, record: Record, signals: Sequence[str], given: Mapping[str, Values]) -> Behind:
    """Return what a diagram's signals do between rows behind switches of the record's set points.

    ``given`` block.parameter -> one value a run.  A run that fails adds nothing.
    """
    log = record.log
    rows = _rows(record)
    moving = [s for s in signals if moves(diagram, s)]
    if not len(rows) or not moving:
        return NOTHING
    shares = np.array([*SHARES, 1.0 - BEFORE])  # a switch has shown before the row that shows it
    t = np.union1d(log.t[rows - 1, None] + np.diff(log.t)[rows - 1, None] * shares, _around(record))
    t = np.union1d(t, log.t[np.union1d(rows - 1, rows)])  # at which nothing is added
    times = np.union1d(log.t, t)
    many = max((len(v) for v in given.values()), default=1)
    run = ensemble(
        diagram, log.duration, t0=float(log.t[0]), times=times, params=dict(given), seeds=np.zeros(many, dtype=int),
        inputs={s: record.source(s) for s in record.played}, signals=moving,
        progress=False, settings=EXACT,
    )  # fmt: skip
    own, fine = np.searchsorted(times, log.t), np.searchsorted(times, t)
    more = {}
    for s in moving:
        more[s] = np.zeros((many, len(t)))
        for i in np.flatnonzero(run.ok):
            table = line(
                diagram, record, Log(log.t, {s: run.values[s][i, own], **{p: log[p] for p in record.played}}), s
            )
            more[s][i] = run.values[s][i, fine] - np.interp(t, *table)
    return Behind(t, more)


def _rows(record: Record) -> NDArray[np.int64]:
    """Return the rows whose interval before them is behind a switch of a set point."""
    found = np.zeros(len(record.log), dtype=bool)
    for s in record.played:
        if switches(record.log, s):
            early = record.leads.get(s, {})
            for k in switch_rows(record.log, s).tolist():
                found[k + (k not in early) : k + 1 + ROWS] = True
    return np.flatnonzero(found)


def _around(record: Record) -> Values:
    """Return the times [s] just before and at switches between rows."""
    at = [record.log.t[k] - lead for early in record.leads.values() for k, lead in early.items() if k < len(record.log)]
    return np.array([*(t - BEFORE * record.log.dt for t in at), *at])
