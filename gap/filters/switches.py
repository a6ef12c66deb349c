"""When an input switched: the log says between which two rows, a filter says at which scan.

One filter a scan tries the same scan for all switches of an input; each switch takes the scan that is likeliest in the
rows behind.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.filters.filtering import Filtered
from stickslip.gap.records.record import switch_rows, switches

BEHIND = 5  # rows in which a switch shows
MOST = 30  # scans within an interval that are tried; of more, as many spread evenly


def with_switches(now: Filtered) -> Filtered:
    """Return the explanation with its inputs switching at the likeliest scans; the same object if none is likelier."""
    f = now.explanation.filtering
    log = f.record.log
    switching = [j for j, s in enumerate(f.record.played) if switches(log, s)]
    if f.every < 2 or not switching:
        return now
    leads = f.leads.copy()
    options = np.unique(np.linspace(0, f.every - 1, min(f.every, MOST)).round().astype(int))
    for j in switching:  # one after the other: two may switch within the same rows
        loss = []
        for lead in options:
            trial = leads.copy()
            trial[j] = lead
            found = _moved(now, trial)
            if not math.isfinite(found.nll):
                return now
            loss.append(found.losses)
        cost = np.array(loss)
        for row in switch_rows(log, f.record.played[j]):
            leads[j, row] = options[np.argmin(cost[:, row : row + BEHIND].sum(axis=1))]
    if np.array_equal(leads, f.leads):
        return now
    new = _moved(now, leads)
    return new if new.nll < now.nll else now


def _moved(now: Filtered, leads: NDArray[np.int64]) -> Filtered:
    """Return what inputs that switch at other scans leave: the matrices are the same."""
    other = replace(now.explanation, filtering=now.explanation.filtering.with_leads(leads))
    return other.filtered(now.values, matrices=now.explanation.matrices(now.values))
