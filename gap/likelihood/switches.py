"""When an input switched: the log says between which two rows, the filter says when.

Every switch is tried at the same few instants of its interval, one run for each; it takes the instant that is likeliest
in the rows behind.  Of a controller that scans only its scans count.
"""

from dataclasses import replace

import numpy as np

from gap.likelihood.fit import tried
from gap.likelihood.hypothesis import Innovations
from gap.records.record import switch_rows, switches

BEHIND = 5  # rows in which a switch shows
TRIED, FINER = 12, 4  # instants of an interval, and of a part of it
LATE = 1e-6  # share of an interval by which a switch stays behind the row before


def with_switches(now: Innovations) -> Innovations:
    """Return a filter of the same values with inputs that switch when it suits the record; the same if none does."""
    frame = now.hypothesis.frame
    log = frame.record.log
    switching = [s for s in frame.record.played if switches(log, s)]
    if not switching:
        return now
    dt = log.dt
    scanned = frame.scanned
    step = max(scanned, dt / TRIED) if scanned else dt / TRIED
    options = np.arange(0.0, dt * (1.0 - LATE), step)
    best = _placed(now, switching, {s: {} for s in switching}, options, 0.0)
    if best is not now and not scanned:
        near = best.hypothesis.frame.record.leads
        fine = np.linspace(-0.5, 0.5, 2 * FINER + 1) * step
        best = _placed(best, switching, near, fine, dt * (1.0 - LATE))
    if best is now:
        return now
    own = tried(best.hypothesis, now.values)
    return own if own is not None and own.nll < now.nll else now


def _placed(now, switching, about, options, most):  # type: ignore[no-untyped-def]
    """Return what is left if each switch lies at the likeliest of some instants ``about`` where it is thought to be."""
    frame = now.hypothesis.frame
    log = frame.record.log
    rows = {s: switch_rows(log, s).tolist() for s in switching}
    loss, leads = [], []
    for option in options:
        trial = {s: {k: float(np.clip(about[s].get(k, 0.0) + option, 0.0, most or np.inf)) for k in rows[s]} for s in rows}
        found = tried(now.hypothesis.of(_with_leads(frame, trial)), now.values, now)
        if found is None:
            return now
        loss.append(found.losses)
        leads.append(trial)
    cost = np.array(loss)
    chosen = {
        s: {k: leads[int(np.argmin(cost[:, k : k + BEHIND].sum(axis=1)))][s][k] for k in rows[s]} for s in rows
    }  # fmt: skip
    found = tried(now.hypothesis.of(_with_leads(frame, chosen)), now.values, now)
    before = tried(now.hypothesis, now.values, now)
    return found if found is not None and before is not None and found.nll < before.nll - 1.0 else now


def _with_leads(frame, leads):  # type: ignore[no-untyped-def]
    return replace(frame, record=replace(frame.record, leads={s: {k: v for k, v in one.items() if v} for s, one in leads.items()}))
