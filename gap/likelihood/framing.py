"""How a model is held against a record: a filter that follows it, and when its inputs switch."""

import math
from dataclasses import replace

from stickslip.diagram.diagram import Diagram
from stickslip.gap.likelihood.felt import felt
from stickslip.gap.likelihood.frame import BUDGET, Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.inputs import rounded
from stickslip.gap.likelihood.phase import in_phase
from stickslip.gap.likelihood.prepared import NoFilter
from stickslip.gap.likelihood.settling import SETTLING
from stickslip.gap.likelihood.switches import with_ramps, with_switches
from stickslip.gap.null_model.null_model import settling_rows
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import nuisances, silenced
from stickslip.gap.records.record import Record
from stickslip.gap.records.regular import without_unsettled
from stickslip.gap.records.start import start_values, unsure_starts

MORE = (
    50  # times the steps of the model alone, from which on a filter is given up: an effect makes its steps ever smaller
)
SHARES = (1.0, 0.3, 0.0)  # of how unsure a start may be: what no signal soon feels would leave what a law is made for
MOST_BLOCKS, MOST_STATES = 14, 100  # of a diagram that bends; larger ones have an observer of their own


def frame_of(model: Diagram, record: Record, asked: bool = True) -> Frame | None:
    """Return what the hypotheses of a record share; None where no filter follows the model.

    ``asked``: whether the filter is run to see that it does; who runs it anyhow sees an ``ArithmeticError``.

    The filter is for models with loads that nobody measures: without any, a pinned replay leaves nothing to estimate.
    """
    if not any(one.correlation_time > 0.0 for one in nuisances(model)):
        return None
    quiet = silenced(model)
    record = settled_behind_holes(quiet, record)
    frames = (
        Frame(Given(model.starting_at(start)), record, unsure={name: share * sd for name, sd in unsure.items()})
        for start in (start_values(quiet, record), {})
        for unsure in [unsure_starts(quiet.starting_at(start), record)]
        for share in SHARES
    )
    try:
        return next((found for frame in frames if (found := _followed(frame, asked)) is not None), None)
    except NoFilter:
        return None


def _followed(frame: Frame, asked: bool) -> Frame | None:
    """Return a frame whose filter follows the record; None where it does not from such a start.

    Raises ``NoFilter`` for a model that has none from any.
    """
    try:
        alone = Hypothesis(frame)
        exactly = alone.exactly(alone.nominal)
        if exactly is not None and not felt(exactly):
            return frame
        alone = Hypothesis(replace(frame, doubts=rounded(frame.record)))
        if len(frame.model.blocks) > MOST_BLOCKS or len(alone.prepared.states) > MOST_STATES:
            raise NoFilter(f"the model has more than {MOST_BLOCKS} blocks or {MOST_STATES} states")
        most = min(MORE * alone.filtered({}).steps, BUDGET) if asked else BUDGET
    except ArithmeticError:
        return None
    return replace(alone.frame, most_steps=most)


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
    for _ in range(SETTLING):  # a switch that is wrongly placed hides when scans are
        placed = _until_placed(now)
        now = in_phase(placed)
        if now is placed:
            break
    return now.hypothesis.frame


def _until_placed(now: Innovations) -> Innovations:
    """Return a filter of the same values with inputs that switch when it suits the record, until none moves further."""
    for _ in range(SETTLING):
        before, now = now, with_switches(now)
        if now is before:
            break
    return now
