"""Pinned replays side by side: what each pin had to add at each row (``stickslip.diagram.pins``)."""

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.diagram.branches import Branches
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.diagram.pins import replays
from stickslip.gap.records.record import Record
from stickslip.logs import Log
from stickslip.logs.arrays import Values

READY = 128  # diagrams that stay pinned to a record: those of a whole catalogue, on its first part too


def offsets(
    diagram: Diagram,
    record: Record,
    params: Mapping[str, ArrayLike] | None = None,
    start: Mapping[str, ArrayLike] | None = None,
    logs: Sequence[Log] | None = None,
    workers: int | None = None,
) -> Values:
    """Return what the pins add, (runs, rows, pinned signals); NaN where any is missing, or a run failed.

    ``params``, ``start``: block.name -> one value a run, or one for all.  ``logs``: one a run in place of the record's,
    with the same signals and rows.  ``workers`` threads, all cores if None.
    """
    return branched(diagram, record, params, start, logs, workers=workers)[0]


def branched(
    diagram: Diagram,
    record: Record,
    params: Mapping[str, ArrayLike] | None = None,
    start: Mapping[str, ArrayLike] | None = None,
    logs: Sequence[Log] | None = None,
    branches: Branches | None = None,
    workers: int | None = None,
) -> tuple[Values, Values]:
    """Return the offsets, as ``offsets`` does, and how many ``branches`` were kept in each run, (runs,)."""
    if record.filter is not None:
        found = record.filter.residuals(diagram, record, params, logs)
        found[:, _missing(record)] = np.nan
        return found, np.zeros(len(found))
    keep = [f"{s}:offset" for s in record.pinned]
    given = {key: np.atleast_1d(np.asarray(v, dtype=float)) for key, v in (params or {}).items()}
    if logs is None:
        log = record.log
        t0 = np.full(1 if not given and not start else (), log.t[0])  # an array says that there is one run
        many = ensemble(
            held(diagram, record), log.duration, t0=t0, times=log.t, params=given, start=start,
            signals=keep, progress=False, branches=branches, workers=workers,
        )  # fmt: skip
    else:
        signals = [*record.played, *record.pinned]
        many = replays(
            diagram, list(logs), signals=signals, keep=keep, params=given, start=start, fresh=record.fresh,
            progress=False, branches=branches,
        )  # fmt: skip
    found = np.stack([many.values[f"{s}:offset"] for s in record.pinned], axis=-1)
    found[~many.ok] = np.nan
    found[:, _missing(record)] = np.nan
    return found, np.array([float(len(one)) for one in many.taken]) if many.taken else np.zeros(len(found))


@lru_cache(maxsize=READY)
def held(diagram: Diagram, record: Record) -> Diagram:
    """Return the diagram pinned to a record; the same one again for the next replays of it."""
    return diagram.pinned(record.log, [*record.played, *record.pinned], record.fresh)


def _missing(record: Record) -> NDArray[np.bool_]:
    """Return the rows at which a signal is missing: one that is misleads all others, (rows,)."""
    return np.asarray(~np.all([record.log.good(s) for s in record.pinned], axis=0))
