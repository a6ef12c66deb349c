"""Which further tag, or which move of the set point, would separate effects that a record does not.

The model is run freely with each of the effects, silent, on the set points of the record and on a staircase of its own;
a signal separates two effects if it differs between the runs by more than ``PART`` of its span.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.simulation import simulate
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.scales import ends
from stickslip.logs import Log

Floats = NDArray[np.float64]
PART = 1e-3  # of the span of a signal, or of its range where no block states one: a difference that shows
STAIRS = (0.0, 1.0, -1.0, 0.5, -0.5, 0.0)  # of the set point's range in the record, beyond its mean: a staircase
MOVED = 10.0  # by how much a staircase has to show more than the record


def tags(problem: Problem, same: Sequence[Fit]) -> tuple[str, ...]:
    """Return signals that are not logged and differ between every two of some effects, those that differ most first."""
    runs = [_run(problem, fit, _played(problem)) for fit in same if not fit.effect.of_log]
    if len(runs) < 2:
        return ()
    logged = {*problem.record.log.names, *problem.record.pinned}
    found = {}
    for s in problem.quiet.signals:
        if s not in logged and all(s in run for run in runs):
            span = _span(problem.quiet, s, runs[0][s])
            least = min(_apart(one[s], other[s]) for one, other in combinations(runs, 2))
            if least > PART * span:
                found[s] = least / span
    return tuple(sorted(found, key=lambda s: -found[s]))


def staircase_separates(problem: Problem, same: Sequence[Fit]) -> bool:
    """Return whether steps over the range of the set points would show what the record does not, in logged signals."""
    now, then = _played(problem), {}
    for s, values in now.items():
        rows, half = len(values), 0.5 * float(np.ptp(values)) or 0.1 * max(abs(float(values[0])), 1.0)
        steps = np.repeat(STAIRS, -(-rows // len(STAIRS)))[:rows]
        then[s] = float(values.mean()) + 2.0 * half * steps
    least = []
    for played in (now, then):
        runs = [_run(problem, fit, played) for fit in same if not fit.effect.of_log]
        if not played or len(runs) < 2:
            return False
        pairs = combinations(runs, 2)
        least.append(
            min(
                max(_apart(a[s], b[s]) / _span(problem.quiet, s, runs[0][s]) for s in problem.record.pinned)
                for a, b in pairs
            )
        )
    return least[1] > PART and least[1] > MOVED * least[0]


def _played(problem: Problem) -> dict[str, Floats]:
    return {s: np.asarray(problem.record.log[s]) for s in problem.record.played}


def _run(problem: Problem, fit: Fit, played: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return the signals of a free, silent run of the model with the effect of a fit."""
    log = problem.record.log
    model = fit.effect.started(inserted(problem.quiet, fit), fit.place, problem.record.first) if fit.present else (
        problem.quiet
    )  # fmt: skip
    inputs = Log(log.t, dict(played)) if played else None
    run = simulate(model, log.duration, t0=float(log.t[0]), times=log.t, inputs=inputs)
    return {s: run.log[s] for s in run.log.names}


def _apart(one: Floats, other: Floats) -> float:
    return float(np.sqrt(np.mean((one - other) ** 2)))


def _span(diagram: Diagram, signal: str, values: Floats) -> float:
    known = ends(diagram, signal)
    return known[1] - known[0] if known else max(float(np.ptp(values)), 1e-12)
