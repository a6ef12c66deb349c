"""Whether an explanation is good enough to be named: what it leaves must be what records of its own would leave.

1. F is within what records without a gap have, or
2. F is within what runs of the model with the effect, in its own noise, have when they are explained by it, or
3. it explains nearly the whole gap: a law that differs a little from the true one leaves a little.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.noise import is_noise
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.floor import scored, without_gap
from stickslip.gap.floors.modes import CHARGE
from stickslip.gap.floors.problem import SIGMAS, Problem

GAINED = 12.0  # nats that an effect must gain, at least
INEXACT = 0.005  # nats a row that another integrator may cost, where the floor is as sharp as rounding
EXPLAINED, EXPLAINED_HIDDEN = 0.94, 0.85  # share of a gap that an adequate effect explains
EXPLAINED_BETWEEN = 0.5  # the same of a stem that sticks where no replay closes its loop between two rows
LEAST = 0.7  # share of a gap that an effect explains whose own runs leave as much
EXPLAINED_LIMIT, STANDING = 0.7, 0.003  # the same for a limit at which a share of the rows stands
OWN_RUNS = 4  # runs of the model with the effect


def needed(problem: Problem) -> float:
    """Return the gain in log likelihood from which on an effect is worth reporting."""
    return GAINED + (0.0 if problem.floor.coloured else INEXACT * problem.rows)


def share(problem: Problem, fit: Fit) -> float:
    """Return the share of the gap that a fit explains."""
    removable = problem.score - problem.level
    return (problem.score - scored_alone(fit)) / removable if removable > 1e-9 else 1.0


def scored_alone(fit: Fit) -> float:
    """Return the score of a fit's innovations, in their own unit, with what modes set right cost."""
    return float(scored(fit.e)) + fit.charge


def complete(problem: Problem, fit: Fit) -> bool:
    """Return whether a fit leaves no more than records of the model, or of the model with the effect, leave."""
    if fit.candidate.noisy and not is_noise(fit):
        return False
    left = scored_alone(fit)
    if left <= problem.limit + needed(problem):
        return True
    # Runs with a hidden mode that is missed now and then leave anything: that alone proves nothing.
    return share(problem, fit) >= LEAST and left <= own_limit(problem, fit)


def adequate(problem: Problem, fit: Fit) -> bool:
    """Return whether a fit explains so much of the gap that only its law can be a little different.

    At a limit at which the log stands, when exactly an integral stops is a matter of the controller's own step: there
    it is enough that nothing is left elsewhere.
    """
    if fit.candidate.noisy and not is_noise(fit):
        return False
    enough = EXPLAINED_HIDDEN if fit.effect.hidden else EXPLAINED
    if fit.effect.hidden and problem.record.filter is not None:  # a slip between two rows bends what drives the stem
        enough = EXPLAINED_BETWEEN
    if share(problem, fit) >= enough:
        return proven(problem, fit)
    away = ~standing(problem, fit)
    if away.all():
        return False
    e = fit.e[away]
    usual = problem.floor.mean * len(e) + SIGMAS * problem.floor.sd * float(np.sqrt(len(e)))
    return share(problem, fit) >= EXPLAINED_LIMIT or float(scored(e)) <= usual + needed(problem)


def proven(problem: Problem, fit: Fit) -> bool:
    """Return whether a fit that leaves something may be named: a limit only if the log stands there."""
    return fit.candidate.own != ("low", "high") or stands(problem, fit)


def stands(problem: Problem, fit: Fit) -> bool:
    """Return whether a logged signal stands at the limit that a fit puts there; the digits prove such a limit."""
    return bool(standing(problem, fit).any())


def standing(problem: Problem, fit: Fit) -> NDArray[np.bool_]:
    """Return the scored rows at and next to which a logged signal stands at the fitted limit, (rows,)."""
    log, base = problem.record.log, fit.candidate.base
    found = np.zeros(len(log), dtype=bool)
    if fit.candidate.own == ("low", "high"):
        percent = fit.effect.parameters[0].unit.startswith("%")
        for s in (str(s) for s in base[fit.place].output_labels if str(s) in log):
            low, high = base.signal_spans.get(s, (0.0, 1.0))
            near = max(1.5 * problem.record.lattice(s), 1e-5 * (high - low))
            for name in (n for n in fit.candidate.own if fit.values[n] != fit.candidate.nominal[n]):
                at = low + 0.01 * fit.values[name] * (high - low) if percent else fit.values[name]
                rows = np.abs(log[s] - at) <= near
                if float(rows.mean()) > STANDING:
                    found |= rows
    found[1:-1] |= found[:-2] | found[2:]
    return found[problem.floor.skipped :]


def own_limit(problem: Problem, fit: Fit) -> float:
    """Return the score that runs of the model with the effect do not exceed when they are explained by it."""
    if fit.candidate.noisy:
        return problem.limit
    model, quiet = (
        fit.effect.started(inserted(diagram, fit), fit.place, problem.record.first)
        for diagram in (problem.model, problem.quiet)
    )
    logs = without_gap(model, problem.record, OWN_RUNS, 1)
    if not logs:
        return problem.limit
    e, kept = replace(problem, start={}).replayed(quiet, logs=logs)
    scores = scored(e) + CHARGE * kept
    scores = scores[np.isfinite(scores)]
    if len(scores) < 2:
        return problem.limit
    spread = max(float(scores.std(ddof=1)), problem.floor.sd * float(np.sqrt(problem.known)))
    return float(scores.mean()) + SIGMAS * spread + needed(problem)
