"""What a filter's residuals are without a gap, and which segments of a record leave that.

A segment is a controller with what is before it, back to logged signals; the process with its valves is another.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagram.diagram import Diagram
from gap.floors.floor import Floor, floor_of, losses, residuals, settling_rows, without_gap
from gap.linearised.filtered import Filter
from gap.linearised.instants import with_switches
from gap.linearised.parts import ancestors
from gap.records.record import Record

Floats = NDArray[np.float64]
FOLDS = 4  # parts of the runs, each of which tells the score of a floor made of the others
FAR = 6.0  # medians of a residual beyond which it says nothing of the usual size
SIGMAS = 4.5  # by which a segment's loss may exceed its mean without a gap


@dataclass(frozen=True, eq=False)
class Usual:
    """Residuals of single signals without a gap: their ``unit``, ``mean`` and standard deviation ``sd`` of their loss,
    (signals,) each.
    """

    unit: Floats
    mean: Floats
    sd: Floats


def floor_of_record(
    model: Diagram, quiet: Diagram, record: Record, runs: int, seed: int
) -> tuple[Record, Floor, Usual]:
    """Return a record with what its filter expects, and its floor, from ``runs`` runs of the model from ``seed`` on."""
    filter = _filter(record)
    record = with_switches(quiet, record, filter)
    found = filter.residuals(quiet, record, None, without_gap(model, record, runs, seed))
    behind = filter.gains(record).which > 0
    judged = [s in filter.parts.judged for s in record.pinned]
    settling = settling_rows(model, record)

    def told(others: Floats) -> tuple[Floats, Floor]:
        """Return what is expected of each row, and the floor, from some runs."""
        expected = np.where(behind[:, None], np.nan_to_num(np.nanmean(others, axis=0)), 0.0)
        bound = FAR * np.nanmedian(np.abs(others - expected), axis=(0, 1))  # rows right behind a jump set no scale
        bound[judged] = np.inf
        return expected, floor_of(np.clip(others - expected, -bound, bound), settling, judged, True)

    folds = np.arange(len(found)) % FOLDS
    scores = []
    for fold in range(FOLDS):  # runs judge a floor made of others: a record is as new to it as they are
        expected, floor = told(found[folds != fold])
        scores.append(floor.score(found[folds == fold] - expected))
    floor = replace(floor, scores=np.sort(np.concatenate(scores)))
    found = found - expected
    r = residuals(found, floor.changes)[:, floor.skipped :]
    unit = np.sqrt(np.nanmean(r**2, axis=(0, 1)))
    loss = losses(r / unit).mean(axis=1)
    usual = Usual(unit, loss.mean(axis=0), loss.std(axis=0, ddof=1))
    return replace(record, filter=replace(filter, expected=expected)), floor, usual


def suspected(quiet: Diagram, record: Record, floor: Floor, usual: Usual) -> Record:
    """Return a record with the blocks of the segments whose own residuals leave their floor."""
    parts = _filter(record).parts
    r = residuals(_filter(record).residuals(quiet, record, None, None)[0], floor.changes)[floor.skipped :]
    loss = losses(r / usual.unit).mean(axis=0)
    left = {s for s, far in zip(record.pinned, loss > usual.mean + SIGMAS * usual.sd, strict=True) if far}
    found = {name for s in left & set(parts.judged) for name in ancestors(quiet, [s], set(record.log.names))}
    if left & set(parts.measured) or not left:
        found |= {*parts.fed, *parts.rest}
    return replace(record, suspects=tuple(block.name for block in quiet.blocks if block.name in found))


def _filter(record: Record) -> Filter:
    if not isinstance(record.filter, Filter):
        raise TypeError("the record has no filter")
    return record.filter
