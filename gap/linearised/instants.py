"""When a set point switched between two rows, as the filter finds it from the rows of the log.

The log says between which two rows a set point switched.  The later it did, the less of the new value a controller has
taken in by the next row, and the less a pressure has followed.  So each switch has one instant, a share of the interval
before the row that shows it, and that is taken which leaves the least in the rows behind it.

A filter takes what a valve does in such an interval for a straight line, which leaves something even at the true
instant.  What it leaves of a run of the model itself, with its switches at the instants that are tried, is taken off.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.linearised.filtered import Filter, known_to
from stickslip.gap.null_model.null_model import losses, undisturbed
from stickslip.gap.records.record import Record, switch_rows, switches
from stickslip.logs.arrays import Values
from stickslip.logs.normal import OF_SIZES

Switch = tuple[str, int]  # the set point, and the row that shows its switch
SHARES = (0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 0.97)  # of an interval that are tried first
AGAIN = (0.0, 0.25, 0.5, 0.75, 0.97)  # those that are tried of a switch whose neighbour has been told
FINER = (0.12, 0.06, 0.03, 0.015)  # steps to both sides of the best
BEHIND = 4  # rows in which a switch shows
LEAST = 1e-3  # scale, at least, of what a measurement shows beyond its prediction, in its standard deviations
NEAR = 4  # rows between what two switches show, below which each is told with the other held
SURE = 25.0  # nats by which a switch is surely between two rows
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

    def left(shares: Mapping[Switch, float]) -> Values:
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
    scale = np.maximum(OF_SIZES * np.nanmedian(np.abs(plain), axis=0), least)
    everywhere = {(s, k): 0.0 for s in rows for k in rows[s]}
    losses_at: dict[Switch, dict[float, float]] = {one: {} for one in everywhere}  # switch -> share -> loss behind it

    def tried(shares: Mapping[Switch, float], moved: Iterable[Switch]) -> None:
        loss = left(shares)
        for one in moved:
            losses_at[one][shares[one]] = float(loss[one[1] : one[1] + BEHIND].sum())

    for share in (0.0, *SHARES):
        tried(dict.fromkeys(everywhere, share), everywhere)
    # where one switch is surely between rows, all may be
    worth = 0.0 if any(one[0.0] - min(one.values()) > SURE for one in losses_at.values()) else WORTH
    best = _best(losses_at, worth)
    if not any(best.values()):
        return record
    if not worth:
        for moved in _in_turn(losses_at):
            for one in moved:
                losses_at[one].clear()
            for share in AGAIN:
                tried({**best, **dict.fromkeys(moved, share)}, moved)
            best = _best(losses_at, worth)
    for finer in FINER:
        for way in (-finer, finer):
            near = {one: min(max(share + way, 0.0), 0.99) if share > 0.0 else 0.0 for one, share in best.items()}
            tried(near, everywhere)
        best = _best(losses_at, worth)
    leads = {
        s: {k: best[s, k] * float(log.t[k] - log.t[k - 1]) for k in rows[s] if best[s, k] > 0.0} for s in rows
    }  # fmt: skip
    return replace(record, leads={s: early for s, early in leads.items() if early})


def _best(losses_at: Mapping[Switch, Mapping[float, float]], worth: float) -> dict[Switch, float]:
    """Return the share of least loss of each switch; one between rows costs ``worth`` [nats]."""
    return {
        one: min(by_share, key=lambda share: by_share[share] + worth * (share > 0.0))
        for one, by_share in losses_at.items()
    }  # fmt: skip


def _in_turn(switches_: Iterable[Switch]) -> list[list[Switch]]:
    """Return the switches that lie so near to another that each is told with the other held, in two groups.

    >>> _in_turn([("SP_1", 20), ("SP_2", 22), ("SP_1", 90)])
    [[('SP_1', 20)], [('SP_2', 22)]]
    """
    ordered = sorted(switches_, key=lambda one: one[1])
    groups: list[list[Switch]] = [[], []]
    turn = 0
    for k, one in enumerate(ordered):
        beside = [other for other in ordered[max(k - 1, 0) : k + 2] if other is not one]
        if any(abs(other[1] - one[1]) < BEHIND + NEAR for other in beside):
            groups[turn].append(one)
            turn = 1 - turn
    return [group for group in groups if group]
