"""When a set point switched, of which the log says only between which two rows.

Where the controller scans more often than the log is written, that scan is taken for each switch that leaves the
smallest innovations in the rows behind it; switches are far apart, so one replay tries the same scan for all of them.
A continuous controller has integrated the new set point since the instant of the switch:

    e(lead) = e(0) + b lead,   lead = -b e / (b b)        b by a replay a bit earlier, three times over

and the instant counts only where it explains the rows behind the switch: else that switch stays at its row.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close, source_name
from stickslip.gap.floors.floor import losses
from stickslip.gap.floors.problem import Problem
from stickslip.gap.records.record import switch_rows, switches

Floats = NDArray[np.float64]
BEHIND = 3  # rows in which a switch shows
MOST = 10  # scans within an interval that are tried
ROUNDS = 3  # of lines through what the instants do
PROBE = 0.05  # of an interval by which a switch is moved to see what that does
SHOWN = 10.0  # nats by which a switch between rows shows
LEFT, SHARE = 10.0, 0.01  # nats, or share of the squares, that the rows behind it may keep: an effect may lie there too


def with_instants(problem: Problem, explained: Diagram | None = None) -> Problem:
    """Return the problem with the switches of its logged inputs at the scans that suit the record best.

    ``explained``: the silent model with an effect, if the scans are to suit that.
    """
    log = problem.record.log
    seen = problem.quiet if explained is None else explained
    blocks = problem.quiet.blocks
    continuous = any(block.role is Role.CONTROLLER and not block.sampled for block in blocks)
    periods = [] if continuous else [block.period for block in blocks if block.sampled and block.ports_in]
    scans = min(round(log.dt / min(periods)), MOST) if periods else 1
    switching = [s for s in problem.record.played if switches(log, s)]
    if not switching or (periods and scans < 2):
        return problem
    if not periods:  # a large diagram has a way of its own
        return _between_rows(problem, seen, switching) if problem.record.filter is None else problem
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
    return _with_leads(problem, leads)


def _between_rows(problem: Problem, seen: Diagram, switching: list[str]) -> Problem:
    """Return the problem of a continuous controller with switches at the instants that explain the rows behind them."""
    log = problem.record.log

    def behind(leads: dict[str, Floats]) -> Floats:
        return np.asarray(np.nan_to_num(problem.innovations(_closed(problem, seen, leads))[0]))

    rows = {s: [int(k) for k in switch_rows(log, s) if k >= problem.floor.skipped] for s in switching}
    leads = {s: np.zeros(len(log)) for s in switching}
    begun = now = np.nan_to_num(problem.as_it_is) if seen is problem.quiet else behind(leads)
    if not any(_loss(now, problem, k).max() > SHOWN for s in switching for k in rows[s]):
        return problem if seen is problem.quiet else _with_leads(problem, leads)
    for _ in range(ROUNDS):
        probed = behind({s: lead + PROBE * log.dt for s, lead in leads.items()})
        for s in switching:
            for k in rows[s]:
                part = _rows(problem, k)
                b = (probed[part] - now[part]) / (PROBE * log.dt)
                j = int(np.argmax((b**2).sum(axis=0)))  # what the set point drives at once
                slope = float(b[:, j] @ b[:, j])
                step = -float(b[:, j] @ now[part][:, j]) / slope if slope > 0.0 else 0.0
                leads[s][k] = np.clip(leads[s][k] + step, 0.0, (1.0 - PROBE) * log.dt)
        now = behind(leads)
    found = {}
    for s in switching:
        good = np.zeros(len(log))
        for k in rows[s]:
            before, after = _loss(begun, problem, k), _loss(now, problem, k)
            j = int(np.argmax(before - after))
            was, left = (e[_rows(problem, k), j] for e in (begun, now))
            gone = after[j] < LEFT or float(left @ left) < SHARE * float(was @ was)
            if before[j] - after[j] > SHOWN and gone:
                good[k] = leads[s][k]
        found[s] = good
    if seen is problem.quiet and not any(good.any() for good in found.values()):
        return problem
    return _with_leads(problem, found)


def _rows(problem: Problem, k: int) -> slice:
    return slice(k - problem.floor.skipped, k - problem.floor.skipped + BEHIND)


def _loss(e: Floats, problem: Problem, k: int) -> Floats:
    """Return the loss of the rows behind a switch, of each signal [nats]."""
    return np.asarray(losses(e[_rows(problem, k)]).sum(axis=0))


def _with_leads(problem: Problem, leads: dict[str, Floats]) -> Problem:
    switching = list(leads)
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
