"""When a set point switched between two rows, told by the filter from the log's own rows.

The log says between which two rows a set point switched.  The later it did, the less of the new value a controller has
taken in by the next row, and the less a pressure has followed.  So each switch has one instant, a share of the interval
before the row that shows it, and that is taken which leaves the least in the rows behind it.

A filter takes what a valve does in such an interval for a straight line, which leaves something even at the true
instant.  What it leaves of a run of the model itself, with its switches at the instants that are tried, is taken off.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagram.diagram import Diagram
from gap.floors.floor import losses, undisturbed
from gap.linearised.filtered import Filter, known_to
from gap.records.record import Record, switch_rows, switches

Floats = NDArray[np.float64]
SHARES = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 0.97)  # of an interval that are tried first
FINER = (0.06, 0.03, 0.015)  # steps to both sides of the best
BEHIND = 4  # rows in which a switch shows
LEAST = 1e-3  # scale, at least, of what a measurement shows beyond its prediction, in its standard deviations
WORTH = 6.0  # nats that an instant other than the row's own must gain


def with_switches(quiet: Diagram, record: Record, filter: Filter) -> Record:
    """Return the record with the instants of its switches at which a silent model leaves least."""
    log = record.log
    rows = {
        s: switch_rows(log, s).tolist() for s in record.played if switches(log, s)
    }  # fmt: skip
    if not any(rows.values()):
        return record
    judged = np.array([s in filter.parts.judged for s in record.pinned])

    def left(shares: Mapping[tuple[str, int], float]) -> Floats:
        """Return the loss of each row with switches so much of an interval early, (rows,)."""
        leads: dict[str, dict[int, float]] = {s: {} for s in rows}
        for (s, k), share in shares.items():
            if share > 0.0:
                leads[s][k] = share * float(log.t[k] - log.t[k - 1])
        moved = replace(record, leads=leads)
        found = filter.residuals(quiet, moved, None, None)[0]
        found -= np.nan_to_num(filter.residuals(quiet, moved, None, [undisturbed(quiet, moved)])[0])
        found[1:, judged] = np.diff(found[:, judged], axis=0)
        known = filter.gains(moved)  # rows that are known less well weigh less, which is not to be had for nothing
        wide = -np.log(np.abs(np.diagonal(known.root, axis1=1, axis2=2))).sum(axis=1)
        return np.asarray(losses(found / scale).sum(axis=1) + wide[known.which])

    plain = filter.residuals(quiet, record, None, None)[0]
    plain[1:, judged] = np.diff(plain[:, judged], axis=0)
    least = [known_to(record, s) if s in filter.parts.judged else LEAST for s in record.pinned]
    scale = np.maximum(1.4826 * np.nanmedian(np.abs(plain), axis=0), least)
    best = {(s, k): 0.0 for s in rows for k in rows[s]}
    first = left(best)
    at_row = {one: float(first[one[1] : one[1] + BEHIND].sum()) for one in best}
    lowest = {one: loss - WORTH for one, loss in at_row.items()}

    def tried(shares: dict[tuple[str, int], float]) -> None:
        loss = left(shares)
        for one, share in shares.items():
            here = float(loss[one[1] : one[1] + BEHIND].sum())
            if here < lowest[one]:
                lowest[one], best[one] = here, share

    for share in SHARES:
        tried(dict.fromkeys(best, share))
    for finer in FINER:
        for way in (-finer, finer):
            near = dict(best)
            tried({one: min(max(share + way, 0.0), 0.99) if share > 0.0 else 0.0 for one, share in near.items()})
    leads = {
        s: {k: best[s, k] * float(log.t[k] - log.t[k - 1]) for k in rows[s] if best[s, k] > 0.0} for s in rows
    }  # fmt: skip
    return replace(record, leads={s: early for s, early in leads.items() if early})
