"""Diagnose the gap between a model and a log: where it lies, which effect causes it, how far it shrinks.

1. Hold the model against the log: by a filter where a load wanders that nobody measures, else by a pinned replay.
2. Find how likely the log is with every effect of the catalogue at every place where it may be.
3. Name the best, with all effects that give the same log; or say "unknown" if none is adequate.
4. Fit again on the first part of the record, and judge on the rest.
5. Where nothing is named, say which mistake of the model or the log would explain the gap (``hints``).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress
from stickslip.gap.answers.report import UNKNOWN, GapReport
from stickslip.gap.calibrating.calibration import kept_calibration
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.hints.hinted import hints
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.diagnosing import outcome
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.logged_stem import logged_stem
from stickslip.gap.likelihood.replay import replays_of
from stickslip.gap.likelihood.reports import report_for
from stickslip.gap.records.model import read
from stickslip.gap.records.record import GapError
from stickslip.logs import Log
from stickslip.logs.processes import one_thread


@one_thread
@np.errstate(over="ignore", invalid="ignore")  # sizes that are tried drive a user's equations out of their domain
def diagnose(
    diagram: Diagram,
    log: Log | Any,
    *,
    catalogue: Sequence[Effect] = CATALOGUE,
    seed: int = 0,
    limits: bool = True,
    progress: Progress = None,
) -> GapReport:
    """Return where the model and the log differ, which effect explains it, and how far the gap shrinks then.

    ``diagram`` is the model, with its noise and its unmeasured loads as blocks.  ``log`` is a table of signals of the
    diagram, by name, or a run.  ``catalogue`` are the effects that are tried, at every place where each may be; few of
    them take less time.  ``seed`` is that of the runs without a gap.  ``limits=False`` saves time: the report on a
    record without a gap then does not say from which sizes on effects would have shown.  ``progress`` is a bar (True),
    silence (False), a function of (done, total), or None for a bar where standard error is a terminal.

    Raises ``GapError`` if log and model do not fit together.

    >>> from stickslip.cases.models import ideal_flow
    >>> from stickslip.diagram import simulate
    >>> from stickslip.gap.effects import effect
    >>> plant = effect("controller_gain").insert(ideal_flow(), "controller", factor=1.5)
    >>> run = simulate(plant, 1200.0, every=1.0, inputs={"SP": 0.6})
    >>> known = [effect("controller_gain"), effect("process_gain")]
    >>> cause = diagnose(ideal_flow(), run, catalogue=known, limits=False).causes[0]
    >>> cause.effect, cause.place, round(cause.parameters["factor"].value, 2)
    ('controller_gain', 'controller', 1.5)
    """
    log = getattr(log, "log", log)
    if not isinstance(log, Log):
        raise GapError(
            f"the log is {type(log).__name__}; give a Log: stickslip.logs.read_log('run.csv'), or "
            "stickslip.logs.Log(t, {'PV': ..., 'OP': ...})"
        )
    if not isinstance(diagram, Diagram):
        raise GapError(
            f"the model is {type(diagram).__name__}; give a diagram, e.g. stickslip.diagram.wire([controller, ...])"
        )
    opened, record = read(diagram, log)
    stem = logged_stem(opened, record)
    frame = frame_of(opened, stem.without(record) if stem else record)
    if frame is None:
        stem, frame = None, replays_of(opened, record, seed)
    hit_rates = kept_calibration(opened, record).hit_rates
    found = report_for(outcome(frame, catalogue, seed, progress, stem), limits, seed, hit_rates)
    if all(cause.effect != UNKNOWN for cause in found.causes):
        return found
    return replace(found, hints=hints(opened, record.log), notes=(*found.notes, *without_place(opened, catalogue)))


def without_place(model: Diagram, catalogue: Sequence[Effect]) -> list[str]:
    """Return in a sentence which effects were not tried, though the model has blocks of their role; none for none.

    >>> from stickslip.blocks import Equations
    >>> from stickslip.diagram import wire
    >>> from stickslip.gap.effects import effect
    >>> tank = Equations("tank", der=lambda h, q, area=2.0: (q - h) / area, states={"h": 0.0}, inputs=["q"])
    >>> without_place(wire([tank], inputs=["q"]), [effect("process_gain"), effect("process_time_constant")])
    ['Not tried, since no block has what they change: process_time_constant.']
    """
    roles = {block.role for block in model.blocks}
    names = [one.name for one in catalogue if one.role in roles and not one.places(model)]
    return [f"Not tried, since no block has what they change: {', '.join(names)}."] * bool(names)


def held_against(diagram: Diagram, log: Log, seed: int = 0) -> Frame:
    """Return what all explanations of a log share: the model, the record, and how one is held against the other."""
    opened, record = read(diagram, log)
    return frame_of(opened, record) or replays_of(opened, record, seed)
