"""Which further tag, or which move of the set point, would separate effects that a record does not.

The model is run freely with each of the effects, silent, on the set points of the record and on a staircase of its own;
a signal separates two effects if it differs between the runs by more than ``PART`` of its span.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.simulation import simulate
from stickslip.gap.answers.report import listed
from stickslip.gap.insertion.scales import ends
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.records.model import silenced
from stickslip.logs import Log
from stickslip.logs.arrays import Values

PART = 1e-3  # of the span of a signal, or of its range where no block states one: a difference that shows
STAIRS = (0.0, 1.0, -1.0, 0.5, -0.5, 0.0)  # of the set point's range in the record, beyond its mean: a staircase
MOVED = 10.0  # by how much a staircase has to show more than the record


def next_test(frame: Frame, same: Sequence[Fit]) -> str:
    """Return in words which tag or which move of the set point would separate some effects."""
    found = tags(frame, same)
    if found:
        return f"a log of {listed(found[:3])} would separate them"
    for k in range(2, len(same)):  # not all of them, but some
        found = tags(frame, same[:k])
        if found:
            return f"a log of {listed(found[:3])} would separate some of them"
    if staircase_separates(frame, same):
        return "steps of the set point over a wider range would separate them"
    return "neither another signal of the model nor a wider range of the set point would separate them"


def _of_log(fit: Fit) -> bool:
    return fit.hypothesis.effect is not None and fit.hypothesis.effect.of_log


def tags(frame: Frame, same: Sequence[Fit]) -> tuple[str, ...]:
    """Return signals that are not logged and differ between every two of some effects, those that differ most first."""
    runs = [_run(frame, fit, _played(frame)) for fit in same if not _of_log(fit)]
    if len(runs) < 2:
        return ()
    logged = {*frame.record.log.names, *frame.record.pinned}
    found = {}
    for s in frame.quiet.signals:
        if s not in logged and all(s in run for run in runs):
            span = _span(frame.quiet, s, runs[0][s])
            least = min(_apart(one[s], other[s]) for one, other in combinations(runs, 2))
            if least > PART * span:
                found[s] = least / span
    return tuple(sorted(found, key=lambda s: -found[s]))


def staircase_separates(frame: Frame, same: Sequence[Fit]) -> bool:
    """Return whether steps over the range of the set points would show what the record does not, in logged signals."""
    now, then = _played(frame), {}
    for s, values in now.items():
        rows, half = len(values), 0.5 * float(np.ptp(values)) or 0.1 * max(abs(float(values[0])), 1.0)
        steps = np.repeat(STAIRS, -(-rows // len(STAIRS)))[:rows]
        then[s] = float(values.mean()) + 2.0 * half * steps
    least = []
    for played in (now, then):
        runs = [_run(frame, fit, played) for fit in same if not _of_log(fit)]
        if not played or len(runs) < 2:
            return False
        pairs = combinations(runs, 2)
        least.append(
            min(
                max(_apart(a[s], b[s]) / _span(frame.quiet, s, runs[0][s]) for s in frame.record.pinned)
                for a, b in pairs
            )
        )
    return least[1] > PART and least[1] > MOVED * least[0]


def _played(frame: Frame) -> dict[str, Values]:
    return {s: np.asarray(frame.record.log[s]) for s in frame.record.played}


def _run(frame: Frame, fit: Fit, played: Mapping[str, Values]) -> dict[str, Values]:
    """Return the signals of a free, silent run of the model with the effect of a fit."""
    log = frame.record.log
    model = silenced(fit.hypothesis.model(fit.best.values))
    inputs = Log(log.t, dict(played)) if played else None
    run = simulate(model, log.duration, t0=float(log.t[0]), times=log.t, inputs=inputs)
    return {s: run.log[s] for s in run.log.names}


def _apart(one: Values, other: Values) -> float:
    return float(np.sqrt(np.mean((one - other) ** 2)))


def _span(diagram: Diagram, signal: str, values: Values) -> float:
    known = ends(diagram, signal)
    return known[1] - known[0] if known else max(float(np.ptp(values)), 1e-12)
