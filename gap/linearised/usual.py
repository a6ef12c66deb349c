"""What a filter's residuals are without a gap, and which segments of a record leave that.

Runs of the model with the record's own set points tell scales and colours, and how far a score goes from run to run.

A segment is a controller with what is before it, back to logged signals; the process with its valves is another.
"""

from dataclasses import dataclass, replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.linearised.filtered import Filter
from stickslip.gap.linearised.instants import with_switches
from stickslip.gap.linearised.parts import ancestors
from stickslip.gap.null_model.null_model import (
    NullModel,
    losses,
    null_model_of,
    residuals,
    scored,
    settling_rows,
    undisturbed,
    usual_runs,
)
from stickslip.gap.records.offsets import offsets
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

FOLDS = 4  # parts of the runs, each of which tells the score of a null model made of the others
FAR = 6.0  # medians of a residual beyond which it says nothing of the usual size
SIGMAS = 4.5  # by which a segment's loss may exceed its mean without a gap


@dataclass(frozen=True, eq=False)
class Usual:
    """Residuals of single signals without a gap: their ``unit``, ``mean`` and standard deviation ``sd`` of their loss,
    (signals,) each.
    """

    unit: Values
    mean: Values
    sd: Values


def null_model_of_record(
    model: Diagram, quiet: Diagram, record: Record, runs: int, seed: int
) -> tuple[Record, NullModel, Usual]:
    """Return a record with what its filter expects, and its null model: that of ``runs`` runs of the model from
    ``seed`` on, driven as the record's system was.  Raises ``GapError`` if no run comes to its end.
    """
    record = _expecting(quiet, with_switches(quiet, record, _filter(record)))
    filter = _filter(record)
    found = offsets(quiet, record, logs=usual_runs(model, record, runs, seed))  # nothing where the log has nothing
    null_model = _shape(found, settling_rows(model, record), [s in filter.parts.judged for s in record.pinned])
    return record, null_model, _usual(null_model, found)


def _expecting(quiet: Diagram, record: Record) -> Record:
    """Return a record whose filter expects what it leaves of an undisturbed run of the model behind switches."""
    filter = _filter(record)
    left = np.nan_to_num(filter.residuals(quiet, record, None, [undisturbed(quiet, record)])[0])
    behind = filter.gains(record).which > 0
    return replace(record, filter=replace(filter, expected=np.where(behind[:, None], left, 0.0)))


def _shape(found: Values, settling: float, judged: list[bool]) -> NullModel:
    """Return the null model of residuals of runs without a gap, (runs, rows, signals).

    Its scores are those of runs that it is not made of: a record is as new to it as they are.
    """
    folds = np.arange(len(found)) % FOLDS
    scores = []
    for fold in range(FOLDS):
        others = found[folds != fold]
        bound = FAR * np.nanmedian(np.abs(others), axis=(0, 1))  # rows right behind a jump set no scale
        bound[judged] = np.inf
        null_model = null_model_of(np.clip(others, -bound, bound), settling, judged, True)
        e = null_model.innovations(found[folds == fold])
        scores.append(scored(e) / np.isfinite(e).mean(axis=(1, 2)))  # of all rows, logged or not
    whole = np.concatenate(scores)
    return replace(null_model, scores=np.sort(whole[np.isfinite(whole)]))


def _usual(null_model: NullModel, found: Values) -> Usual:
    """Return what single signals leave, of residuals of runs without a gap, (runs, rows, signals)."""
    r = residuals(found, null_model.changes)[:, null_model.skipped :]
    unit = np.sqrt(np.nanmean(r**2, axis=(0, 1)))
    loss = losses(r / unit).mean(axis=1)
    return Usual(unit, loss.mean(axis=0), loss.std(axis=0, ddof=1))


def suspected(quiet: Diagram, record: Record, null_model: NullModel, usual: Usual) -> Record:
    """Return a record with the blocks of the segments whose own residuals exceed their null model."""
    parts = _filter(record).parts
    r = residuals(_filter(record).residuals(quiet, record, None, None)[0], null_model.changes)[null_model.skipped :]
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
