"""How a model is held against a record: a filter that follows it, and when its inputs switch."""

import math
from dataclasses import replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.engine.restarts import standing
from stickslip.gap.floors.floor import settling_rows
from stickslip.gap.likelihood.felt import felt
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.inputs import rounded
from stickslip.gap.likelihood.phase import in_phase
from stickslip.gap.likelihood.prepared import NoFilter
from stickslip.gap.likelihood.settling import SETTLING
from stickslip.gap.likelihood.switches import with_ramps, with_switches
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import nuisances, silenced
from stickslip.gap.records.record import Record, switch_rows
from stickslip.gap.records.regular import without_unsettled
from stickslip.gap.records.start import ROWS, start_values

RESTING = 20  # rows in which a model that rests is left alone
MOST_BLOCKS, MOST_STATES = 14, 60  # of a diagram that bends; larger ones have an observer of their own


def frame_of(model: Diagram, record: Record) -> Frame | None:
    """Return what the hypotheses of a record share; None where no filter follows the model."""
    found = followed(model, record)
    return found.hypothesis.frame if found else None


def followed(model: Diagram, record: Record, roughly: bool = False) -> Innovations | None:
    """Return what the model alone leaves of a record, from the likelier start; None where no filter follows it.

    ``roughly``: no other start is asked where the stated one is not far from the log.

    It starts as it is stated, or so that its first rows suit the log, which costs its price: loads and noise of these
    rows move what a log hardly feels, as a hidden slow state, to anywhere.

    The filter is for models with loads that nobody measures: without any, a pinned replay leaves nothing to estimate.
    """
    if not any(one.correlation_time > 0.0 for one in nuisances(model)):
        return None
    quiet = silenced(model)
    record = settled_behind_holes(quiet, record)
    try:
        stated = _from_start(Frame(Given(model), record), True)
        if roughly and stated is not None and not stated.gross:
            return stated
        fitted = start_values(quiet, record)
        other = _from_start(Frame(Given(model.starting_at(fitted)), record))
    except NoFilter:
        return None
    if stated is None or (other is not None and other.nll + 0.5 * len(fitted) * math.log(ROWS) < stated.nll):
        return other
    return stated


def _from_start(frame: Frame, may_rest: bool = False) -> Innovations | None:
    """Return what the model alone leaves; None where no filter follows the record from such a start.

    ``may_rest``: whether the model is asked if it rests there, before its inputs first switch.

    Raises ``NoFilter`` for a model that has none from any.
    """
    try:
        alone = Hypothesis(frame)
        exactly = alone.exactly(alone.nominal)
        if exactly is not None and not felt(exactly):
            return exactly
        alone = Hypothesis(replace(frame, doubts=rounded(frame.record)))
        if len(frame.model.blocks) > MOST_BLOCKS or len(alone.prepared.states) > MOST_STATES:
            raise NoFilter(f"the model has more than {MOST_BLOCKS} blocks or {MOST_STATES} states")
        return (_resting(alone) if may_rest else alone).filtered({})
    except ArithmeticError:
        return None


def _resting(alone: Hypothesis) -> Hypothesis:
    """Return the model alone with the time until which it rests, if it does."""
    frame = alone.frame
    log = frame.record.log
    first = min((int(k) for s in frame.record.played for k in switch_rows(log, s)[:1]), default=len(log))
    until = float(log.t[min(first - 1, RESTING, len(log) - 1)])
    blocks = alone.blocks_with(alone.nominal)
    found = alone.at_rest(blocks, until) if first > 1 else None
    start = standing(alone.prepared.fresh(float(log.t[0]), blocks)[1], alone.places[0])
    still = found is not None and np.array_equal(found, start)
    return replace(alone, frame=replace(frame, rests=until)) if still else alone


def settled_behind_holes(quiet: Diagram, record: Record) -> Record:
    """Return the record without rows behind holes in which an input changed, until the loop has settled."""
    log = record.log
    if all(log.good(s).all() for s in record.pinned):
        return record
    rows = math.ceil(settling_rows(quiet, record))
    return replace(record, log=without_unsettled(log, record.played, record.pinned, rows))


def when_switched(frame: Frame) -> Frame:
    """Return the frame with inputs that switch when it suits the model as it is stated."""
    now = with_ramps(in_phase(Hypothesis(frame).filtered({})))
    for _ in range(SETTLING):
        before, now = now, in_phase(with_switches(now))  # a switch that is wrongly placed hides when scans are
        if now is before:
            break
    return now.hypothesis.frame
