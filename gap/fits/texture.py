"""What the digits of a log show before any physics: values on a lattice, values on straight lines.

lattice        values are multiples of a step.  The historian's rounding leaves OP, which saw finer values of PV, at
               odds with the logged PV; a sensor that gives multiples itself leaves it in accord.
straight       three values on a line that are not equal: a historian that compresses draws lines between those it kept.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.search import Candidate, Fit
from stickslip.gap.floors.cache import keep, kept
from stickslip.gap.floors.floor import measured, residuals, without_gap
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.straightness import deviation_of, sloping
from stickslip.gap.records.offsets import offsets

Floats = NDArray[np.float64]
APART = 3.0  # times the rounding of another signal, from which on a lattice may be a sensor's
IN_ACCORD = 0.3  # of the usual size: residuals this small were not made by the historian's rounding
MOST = 0.8  # quantile of residuals
STRAIGHT = 0.05  # share of straight triples beyond what the model's own runs have
RUNS = 6  # of a rounded or compressed model, which tell what is usual


def in_loop(problem: Problem, seed: int) -> tuple[str, ...]:
    """Return the signals whose lattice is the sensor's own: the others are in better accord than rounding allows."""
    record, floor = problem.record, problem.floor
    if record.filter is not None:  # which takes the controllers' accord for itself
        return ()
    pinned, steps = record.pinned, record.steps
    coarse = tuple(s for s in pinned if steps[s] and any(steps[s] > APART * steps[o] for o in pinned))
    if not coarse:
        return ()
    plain = offsets(problem.quiet, record, logs=without_gap(problem.model, record, RUNS, seed))
    usual, own = (
        np.abs(residuals(found, floor.changes))[:, floor.skipped :] for found in (plain, offsets(problem.quiet, record))
    )
    agree = [
        s for k, s in enumerate(pinned) if s not in coarse and _usual(own[..., k]) < IN_ACCORD * _usual(usual[..., k])
    ]
    return coarse if agree else ()


def _usual(e: Floats) -> float:
    """Return what most of the known values do not exceed; infinite without any."""
    known = e[np.isfinite(e)]
    return float(np.quantile(known, MOST)) if len(known) else np.inf


def with_lattices(problem: Problem, runs: int, seed: int) -> Problem:
    """Return the problem with the noise floor of a log that does not round the signals whose sensor does."""
    found = in_loop(problem, seed)
    if not found:
        return problem
    record = replace(problem.record, lattices=found)
    floor = kept(problem.model, record)
    if floor is None:
        floor, _ = measured(problem.model, problem.quiet, record, runs, seed)
        keep(problem.model, record, floor)
    return replace(problem, record=record, floor=floor)


def fitted_lattice(candidate: Candidate) -> Fit | None:
    """Return a sensor that gives multiples of the step that its signal shows; None where it shows none."""
    record = candidate.problem.record
    own = [str(s) for s in candidate.base[candidate.place].output_labels if str(s) in record.lattices]
    if not own:
        return None
    fits = candidate.tried([{"step": record.lattice(own[0])}])
    return fits[0] if fits else None


def fitted_compression(problem: Problem, effect: Effect, place: str) -> tuple[Fit, bool] | None:
    """Return a compression that makes as many straight triples as the log has, and whether it explains the score.

    None where the log has no more of them than noise makes.
    """
    record = problem.record
    shown = {s: sloping(record.log[s], record.steps[s]) for s in record.pinned if s not in record.lattices}
    if max(shown.values(), default=0.0) <= STRAIGHT:
        return None
    plain = without_gap(problem.model, record, RUNS, 1)
    usual_share = {s: max((sloping(log[s], record.steps[s]) for log in plain), default=1.0) for s in shown}
    signal = max(shown, key=lambda s: shown[s] - usual_share[s])
    if shown[signal] < usual_share[signal] + STRAIGHT:  # what is coarsely rounded has straight lines of its own
        return None
    deviation = deviation_of(plain[0], effect, place, signal, record.steps[signal], record.log[signal])
    logs = [effect.on_log(log, place, deviation=deviation) for log in plain]
    usual = problem.floor.score(offsets(problem.quiet, record, logs=logs))
    candidate = Candidate(problem, problem.quiet, effect, place)
    F = float(usual.mean())
    spread = max(float(usual.std(ddof=1)), problem.floor.sd * problem.rows**0.5)
    explained = abs(problem.score - F) < 6.0 * spread + 0.1 * abs(problem.score - problem.level)
    e = problem.as_it_is / max(1.0, float(np.nanstd(problem.as_it_is)))
    return Fit(candidate, {"deviation": deviation}, problem.level, e), explained
