"""What an effect gains where there is no gap, which it must gain in a record besides.

A filter takes what drives the process from rows that show noise as well; a lag that smooths it foretells measurements
better, gap or none.  A replay knows of noise that is drawn between rows as little; another gain of the controller makes
up for what it adds to OP.  So each effect that may be named is tried, with its sizes, on runs of the model as it is.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Fit, narrowed
from stickslip.gap.floors.floor import scored, without_gap
from stickslip.gap.floors.problem import Problem
from stickslip.logs import Log

Floats = NDArray[np.float64]

MOST = 12  # effects that are tried
RUNS = 6  # of the model without a gap, where no filter has runs of its own
SIGMAS = 3.0  # standard deviations of the gain from run to run that are taken off besides its mean


def priced(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    """Return fits, the best first; each pays what its effect gains by chance in runs without a gap."""
    found = list(fits)
    if not found or found[0].total >= problem.score:
        return found
    filter = problem.record.filter
    logs = (
        without_gap(problem.model, problem.record, RUNS, 1)
        if filter is None
        else filter.own_runs(problem.model, problem.record)
    )
    if len(logs) < 2:
        return found
    plain = problem.innovations(problem.quiet, logs=logs)
    done: list[Fit] = []
    while len(done) < MOST and found[0] not in done and found[0].present:  # the next may be the best once this one is
        best = found[0]
        gain = scored(plain) - _left(problem, best, plain, logs)
        usual = float(np.mean(gain)) + SIGMAS * float(np.std(gain, ddof=1))
        new = replace(best, price=best.price + max(usual, 0.0)) if np.isfinite(usual) else best
        done.append(new)
        found = sorted([new, *found[1:]], key=lambda fit: fit.total)
    return found


def _left(problem: Problem, fit: Fit, plain: Floats, logs: Sequence[Log]) -> Floats:
    """Return the scores of logs that an effect of these sizes explains, (logs,)."""
    if fit.candidate.noisy:
        return np.array([narrowed(replace(fit, e=e)).F for e in plain])
    there = fit.effect.started(inserted(problem.quiet, fit), fit.place, problem.record.first)
    return scored(problem.innovations(there, logs=logs))
