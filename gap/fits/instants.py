"""When a set point switched, where the controller scans more often than the log is written.

The log says between which two rows SP switched, not at which scan.  For each switch the scan is taken that leaves the
smallest innovations in the rows behind it; switches are far apart, so one replay tries the same scan for all of them.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from blocks.recorded import Recorded
from diagram.diagram import Diagram
from diagram.inputs import close, source_name
from gap.floors.floor import losses
from gap.floors.problem import Problem
from gap.records.record import switch_rows, switches

Floats = NDArray[np.float64]
BEHIND = 3  # rows in which a switch shows
MOST = 10  # scans within an interval that are tried


def with_instants(problem: Problem, explained: Diagram | None = None) -> Problem:
    """Return the problem with the switches of its logged inputs at the scans that suit the record best.

    ``explained``: the silent model with an effect, if the scans are to suit that.
    """
    log = problem.record.log
    seen = problem.quiet if explained is None else explained
    periods = [block.period for block in problem.quiet.blocks if block.sampled and block.ports_in]
    scans = min(round(log.dt / min(periods)), MOST) if periods else 1
    switching = [s for s in problem.record.played if switches(log, s)]
    if scans < 2 or not switching:
        return problem
    early = np.arange(scans) * log.dt / scans  # [s] before the row that shows the switch
    tried = [
        losses(problem.innovations(_closed(problem, seen, {s: np.full(len(log), lead) for s in switching})))[0]
        for lead in early
    ]
    loss = np.array([np.sum(one, axis=-1) for one in tried])  # (scans, rows)
    leads = {}
    for s in switching:
        lead = np.zeros(len(log))
        for k in switch_rows(log, s):
            first = max(int(k) - problem.floor.skipped, 0)
            lead[k] = early[int(np.argmin(loss[:, first : first + BEHIND].sum(axis=1)))]
        leads[s] = lead
    return replace(
        problem,
        model=_closed(problem, problem.model, leads),
        quiet=_closed(problem, problem.quiet, leads),
        record=replace(problem.record, played=tuple(s for s in problem.record.played if s not in switching)),
        before=problem,
    )


def _closed(problem: Problem, diagram: Diagram, leads: dict[str, Floats]) -> Diagram:
    """Return a diagram with inputs driven by the log, each switch so much earlier [s] than the row that shows it."""
    log = problem.record.log
    given = {}
    for s, lead in leads.items():
        good = log.good(s)
        values = log[s][good]
        moved = np.concatenate([[True], np.diff(values) != 0.0])
        t = (log.t - lead)[good][moved]
        given[s] = Recorded(s, np.append(t, log.t[-1] + log.dt), np.append(values[moved], values[-1]),
                            hold="previous", name=source_name(diagram, s))  # fmt: skip
    return close(diagram, given)
