"""Diagnose the gap between a model and a log: where it lies, which effect causes it, how far it shrinks.

1. Hold the model to the log; its residuals, at the floor without a gap, are the data (``floor``).
2. Fit every effect of the catalogue at every place where it may be (``candidates``).
3. Name the best, and with it all that would have left the same log; or say "unknown" where none is adequate.
4. Fit again on the first part of the record, judge on the rest (``sizes``).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from diagram.diagram import Diagram
from diagram.progress import Progress
from gap.candidates import candidates, ranked
from gap.effect import Effect
from gap.effects import CATALOGUE
from gap.floor import Floor, measured
from gap.model import nuisances, read, silenced
from gap.problem import Problem
from gap.record import GapError
from gap.report import UNKNOWN, Cause, GapReport, Rank, Shrinkage, Where, listed
from gap.search import Fit, best_of, refined
from gap.sizes import SEEN, shares, shrinkage, sizes
from gap.start import start_values
from gap.texture import with_lattices
from logs import Log

RUNS = 40  # of the model without a gap
GAINED = 12.0  # nats that an effect must gain, at least
INEXACT = 0.005  # nats a row that another integrator may cost, where the floor is as sharp as rounding
TIE = 6.0  # nats between explanations that the record does not tell apart
EXPLAINED, EXPLAINED_HIDDEN = 0.94, 0.88  # share of a gap that an adequate effect explains
LISTED = 12  # explanations in the ranking


def diagnose(
    diagram: Diagram,
    log: Log | Any,
    *,
    catalogue: Sequence[Effect] = CATALOGUE,
    seed: int = 0,
    progress: Progress = None,
) -> GapReport:
    """Return where the model and the log part, which effect of the catalogue explains it, and how far it shrinks then.

    ``diagram`` the model with its nuisances (noise, loads) as blocks; ``log`` a table of signals of the diagram, by
    name.  ``seed`` of the runs without a gap.

    Raises ``GapError`` if log and model do not fit together.
    """
    log = getattr(log, "log", log)
    if not isinstance(log, Log):
        raise GapError(f"the log is {type(log).__name__}; give a Log, e.g. logs.read_log('run.csv')")
    problem = prepared(diagram, log, seed)
    fits = ranked(candidates(problem, problem.quiet, catalogue), progress)
    return _told(problem, fits)


def prepared(diagram: Diagram, log: Log, seed: int = 0, floor: Floor | None = None) -> Problem:
    """Return the problem that a model and a log pose; ``floor`` if it is known from an equal record."""
    model, record = read(diagram, log)
    quiet = silenced(model)
    start = start_values(quiet, record)
    model, quiet = model.starting_at(start), quiet.starting_at(start)
    if floor is None:
        floor, _ = measured(model, quiet, record, RUNS, seed + 1)
    return with_lattices(Problem(model, quiet, record, floor, start), RUNS, seed + 1)


def _told(problem: Problem, fits: Sequence[Fit]) -> GapReport:
    floor, F0 = problem.floor, problem.score
    level, limit = problem.level, problem.limit
    needed = GAINED + (0.0 if floor.coloured else INEXACT * problem.rows)
    best = fits[0] if fits else None
    gained = F0 - best.total if best else 0.0
    t = problem.record.log.t[floor.skipped :]
    notes = _notes(problem)
    if limit >= F0 and gained <= needed:
        words = (
            f"No gap of relevance: the log is as the model with its nuisances would write it "
            f"(score {F0:.0f}, without a gap {level:.0f} on average and {limit:.0f} at most).",
        )
        e = problem.as_it_is
        shown = {s: np.stack([e[:, k], e[:, k]]) for k, s in enumerate(problem.record.pinned)}
        return GapReport(False, None, (), (), None, words, notes, t, shown, problem.quiet)
    share = (F0 - best.F) / max(F0 - level, 1e-9) if best else 0.0
    good = best is not None and (
        limit + needed >= best.F or share >= (EXPLAINED_HIDDEN if best.effect.hidden else EXPLAINED)
    )
    named = tied(fits) if good else []
    explained = shares(fits, F0, level)
    ranking = _ranking(fits, named)
    if best is None or not good:
        place = best.place if best else problem.quiet.blocks[0].name
        near = segment_of(problem, place)
        cause = Cause(UNKNOWN, place, 0.9)
        where = Where(place, 0.5, near, {k: v for k, v in explained.items() if k in near})
        words = [
            f"There is a gap, and nothing in the catalogue explains it: unknown effect at {listed(near)}.",
            f"Nearest: {best.effect.name} at {best.place}, which explains {100 * share:.0f} % of it." if best else "",
        ]
        e = np.stack([problem.as_it_is, best.e if best else problem.as_it_is])
        shown = {s: e[:, :, k] for k, s in enumerate(problem.record.pinned)}
        return GapReport(
            True, where, (cause,), ranking, None, tuple(w for w in words if w), notes, t, shown, problem.quiet
        )
    places = tuple(dict.fromkeys(fit.place for fit in named))
    others = tuple(dict.fromkeys(fit.effect.name for fit in named if fit.effect.name != best.effect.name))
    found = sizes(best)
    cause = Cause(best.effect.name, best.place, 0.9, others, found)
    where = Where(best.place, 0.9, places, {k: v for k, v in explained.items() if k in places})
    shrunk = held_out(best)
    told = ", ".join(
        f"{name} {size.value:.4g} {size.unit} ({size.low:.4g} to {size.high:.4g})" for name, size in found.items()
    )
    words = [
        f"There is a gap. Place: {listed(places)}. Cause: {best.effect.name} at {best.place}, {told}.",
        f"From these signals it cannot be told apart from {listed(others)}." if others else "",
        f"It explains {100 * share:.1f} % of the gap; on rows that the fit has not seen the gap shrinks by "
        f"{100 * shrunk.fraction:.0f} % ({100 * shrunk.low:.0f} to {100 * shrunk.high:.0f} %).",
    ]
    e = np.stack([problem.as_it_is, best.e])
    shown = {s: e[:, :, k] for k, s in enumerate(problem.record.pinned)}
    return GapReport(
        True, where, (cause,), ranking, shrunk, tuple(w for w in words if w), notes, t, shown, problem.quiet
    )


def tied(fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that the record does not tell apart from the best one, which comes first."""
    best = fits[0]
    return [fit for fit in fits if fit.total <= best.total + TIE and fit.price == best.price]


def held_out(fit: Fit) -> Shrinkage:
    """Return how far the gap shrinks behind the part of the record on which the effect is fitted again."""
    candidate, problem = fit.candidate, fit.candidate.problem
    head = replace(problem, record=problem.record.first_part(SEEN))
    again = best_of(replace(candidate, problem=head).tried([fit.values]))
    if again is not None and not fit.effect.hidden:
        again = refined(again, rounds=3)
    after = candidate.tried([again.values if again else fit.values])[0].e
    first = len(head.record.log) - problem.floor.skipped
    return shrinkage(problem.as_it_is, after, problem.floor.mean / len(problem.record.pinned), first)


def segment_of(problem: Problem, place: str) -> tuple[str, ...]:
    """Return the blocks that the logged signals do not tell apart from one of them."""
    for segment in problem.quiet.segments([*problem.record.played, *problem.record.pinned]):
        if place in segment.blocks:
            return tuple(sorted(segment.blocks, key=lambda name: name != place))
    return (place,)


def _ranking(fits: Sequence[Fit], named: Sequence[Fit]) -> tuple[Rank, ...]:
    if not fits:
        return ()
    weight = np.exp(-np.minimum([(fit.total - fits[0].total) / 20.0 for fit in fits], 50.0))
    return tuple(
        Rank(fit.effect.name, fit.place, float(w))
        for fit, w in zip(fits[:LISTED], (0.95 * weight / weight.sum())[:LISTED], strict=True)
    )


def _notes(problem: Problem) -> tuple[str, ...]:
    record = problem.record
    told = [f"{s} rounded to {step:g}" for s, step in record.steps.items() if step]
    found = nuisances(problem.model)
    way = (
        "Residuals of a pinned replay, predicted from earlier ones as a filter of this model would: loads are not measured."
        if problem.floor.coloured
        else "Residuals of a pinned replay, as they are: the nuisances leave them white."
    )
    return (
        f"Logged: {', '.join((*record.played, *record.pinned))}; {len(record.log)} rows, {record.log.dt:g} s apart"
        + (f"; {', '.join(told)}." if told else "."),
        "Nuisances of the model: " + ("; ".join(map(str, found)) if found else "none") + ".",
        way,
    )
