"""Diagnose the gap between a model and a log: where it lies, which effect causes it, how far it shrinks.

1. Pin the model to the log. Its residuals are the data; runs without a gap give their noise floor (``floor``).
2. Fit every effect of the catalogue at every place where it may be (``candidates``).
3. Name the best, with all effects that give the same log; or say "unknown" if none is adequate.
4. Fit again on the first part of the record, and judge on the rest (``sizes``).
5. Where nothing is named, say which mistake of the model or the log would explain the gap (``hints``).

A loop with a load that nobody measures is not replayed, but followed by a filter (``stickslip.gap.likelihood``): its
own Kalman filter where it is linear and scanned (``stickslip.gap.exact``), else one across its own runs.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress
from stickslip.gap.answers.report import UNKNOWN, GapReport
from stickslip.gap.calibrating.calibration import kept_calibration
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.explanations.alternatives import alternatives
from stickslip.gap.explanations.beside_digits import beside_digits
from stickslip.gap.explanations.candidates import candidates, ranked
from stickslip.gap.explanations.chance import priced
from stickslip.gap.explanations.nesting import one_of_nested
from stickslip.gap.explanations.one_of_pair import enough_alone
from stickslip.gap.explanations.other_law import stem_of_other_law
from stickslip.gap.explanations.pairs import beside_stem, paired
from stickslip.gap.explanations.unmeasured import unmeasured_load
from stickslip.gap.fits.adequacy import adequate, complete, needed, stands
from stickslip.gap.fits.instants import with_instants
from stickslip.gap.fits.search import Candidate, Fit, best_of, refined, settled
from stickslip.gap.fits.texture import fitted_compression, with_lattices
from stickslip.gap.floors.cache import keep, kept
from stickslip.gap.floors.floor import Floor, measured
from stickslip.gap.floors.problem import Problem, Settled
from stickslip.gap.hints.hinted import hints
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.diagnosing import frame_of, outcome
from stickslip.gap.likelihood.logged_stem import logged_stem
from stickslip.gap.likelihood.replay import replays_of
from stickslip.gap.likelihood.telling import told as told_by_likelihood
from stickslip.gap.linearised.filtered import filter_of
from stickslip.gap.linearised.usual import floor_of_record, suspected
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.record import FEWEST, GapError, Record
from stickslip.gap.records.start import start_values
from stickslip.gap.telling.words import adequate_pair, named, named_pair, no_gap, tied, unknown
from stickslip.logs import Log
from stickslip.logs.processes import one_thread

AGAIN = 150.0  # nats by which an explanation may lag behind the best to be fitted again
RUNS = 40  # of the model without a gap


@one_thread
def diagnose(
    diagram: Diagram,
    log: Log | Any,
    *,
    catalogue: Sequence[Effect] = CATALOGUE,
    seed: int = 0,
    limits: bool = True,
    progress: Progress = None,
) -> GapReport:
    """Return where the model and the log differ, which effect explains it, and how far it shrinks then.

    ``diagram`` is the model, with its noise and its unmeasured loads as blocks.  ``log`` is a table of signals of the
    diagram, by name.  ``seed`` is that of the runs without a gap.  ``limits=False`` saves time: the report on a record
    without a gap then does not say from which sizes on effects would have shown.

    Raises ``GapError`` if log and model do not fit together.
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
    found = _diagnosed(opened, record, catalogue, seed, limits, progress)
    unknown = any(cause.effect == UNKNOWN for cause in found.causes)
    return replace(found, hints=hints(opened, record.log)) if unknown else found


def _diagnosed(
    opened: Diagram, record: Record, catalogue: Sequence[Effect], seed: int, limits: bool, progress: Progress
) -> GapReport:
    """Return the diagnosis of a record through a model whose logged sources are open."""
    stem = logged_stem(opened, record)
    frame = frame_of(opened, stem.without(record) if stem else record)
    if frame is None:
        stem, frame = None, replays_of(opened, record, seed)
    if frame is not None:
        return told_by_likelihood(
            outcome(frame, catalogue, seed, progress, stem), limits, seed, kept_calibration(opened, record).sureness
        )
    problem = _prepared(opened, record, seed)
    legal = candidates(problem, problem.quiet, catalogue)
    fits = ranked(legal, progress)
    problem, fits = _instants_again(problem, fits)
    fits = priced(problem, fits)
    if problem.record.filter is None or problem.score > problem.limit:  # digits alone prove little of a large diagram
        found = (_compression(problem, one) for one in catalogue if one.of_log)
        compressed = [fit for fit in found if fit is not None]
    else:
        compressed = []
    lattices = [fit for fit in fits if isinstance(fit.effect, Quantisation) and problem.score > fit.F]
    textured = [*compressed, *lattices]
    others = [fit for fit in fits if fit not in lattices]
    return told(problem, [*textured, *others], progress, catalogue, bool(textured), legal if limits else (), seed)


def _instants_again(problem: Problem, fits: list[Fit]) -> tuple[Problem, list[Fit]]:
    """Return the problem with set points switching as suits the best explanation, and the best ones fitted again."""
    if problem.before is None or not fits or fits[0].candidate.noisy or not fits[0].present:
        return problem, fits
    best = fits[0]
    own = {name: best.values[name] for name in best.candidate.own}
    explained = best.effect.insert(problem.before.quiet, best.place, **own)
    held = {key: best.values[key] for key in problem.free if explained.params[key] == problem.quiet.params[key]}
    again = with_instants(problem.before, explained.with_params(held) if held else explained)
    again = replace(again, settled=problem.settled or Settled({}, problem.as_it_is))
    found = []
    for fit in fits:
        near = fit.present and fit.total < best.total + AGAIN
        candidate = Candidate(again, again.quiet, fit.effect, fit.place)
        new = best_of(candidate.tried([fit.values])) if near else None
        new = None if new is None else replace(refined(new, 4), price=fit.price, followed=True)
        found.append(new if new is not None and new.F < fit.F else fit)
    return again, sorted(found, key=lambda fit: fit.total)


def _compression(problem: Problem, effect: Effect) -> Fit | None:
    """Return the fit of an effect of the historian if it explains the record."""
    for place in effect.places(problem.quiet) or ("historian",):
        found = fitted_compression(problem, effect, place)
        if found is not None and found[1]:
            return found[0]
    return None


def prepared(diagram: Diagram, log: Log, seed: int = 0, floor: Floor | None = None) -> Problem:
    """Return the problem that a model and a log pose; ``floor`` is the noise floor, if an equal record has given it
    before.
    """
    return _prepared(*read(diagram, log), seed, floor)


def _prepared(model: Diagram, record: Record, seed: int, floor: Floor | None = None) -> Problem:
    """Return the problem of a model whose logged sources are open."""
    quiet = silenced(model)
    filtered = filter_of(model, quiet, record)
    record = record if filtered is None else filtered
    start = start_values(quiet, record) if filtered is None else {}
    model, quiet = model.starting_at(start), quiet.starting_at(start)
    if filtered is not None:
        record, floor, usual = floor_of_record(model, quiet, record, RUNS, seed + 1)
        record = suspected(quiet, record, floor, usual)
    floor = floor or kept(model, record)
    if floor is None:
        floor, _ = measured(model, quiet, record, RUNS, seed + 1)
        keep(model, record, floor)
    left = len(record.log) - floor.skipped
    if left < FEWEST:
        raise GapError(
            f"of the log's {len(record.log)} rows {max(left, 0)} are left once the model has settled, which is "
            f"too few to tell a gap; give at least {floor.skipped + FEWEST}"
        )
    sure = kept_calibration(model, record).sureness
    problem = with_lattices(Problem(model, quiet, record, floor, start, sureness=sure), RUNS, seed + 1)
    return settled(with_instants(problem))


def told(
    problem: Problem,
    fits: Sequence[Fit],
    progress: Progress,
    catalogue: Sequence[Effect],
    textured: bool,
    legal: Sequence[Candidate] = (),
    seed: int = 0,
) -> GapReport:
    """Return the report of a record whose explanations are known, the best first.

    ``textured``: whether the first is told by the digits of the log, which need no other proof; ``legal`` all
    candidates, of which a record without a gap says what it would have shown.
    """
    fits = one_of_nested(problem, fits)
    best = fits[0] if fits else None
    gained = problem.score - best.total if best else 0.0
    if not textured and problem.score <= problem.limit and gained <= needed(problem):
        return no_gap(problem, legal)
    rival = unmeasured_load(problem, needed(problem))
    if best is None:
        return unknown(problem, fits, rival)
    if textured:
        more = None if best.effect.of_log else beside_digits(problem, best, catalogue, seed + 1, progress)
        if more is not None:
            return named_pair(more.problem, more.pair, ([best], tied(more.fits)), more.fits)
        return named(problem, [best], fits, "digits")
    if complete(problem, best):
        return named(problem, tied(fits), fits, "complete", rival)
    # what leaves something has to be likelier than a load that nobody measures
    beyond = math.inf if rival is None else rival.F - needed(problem)
    good = adequate(problem, best) and (best.total < beyond or stands(problem, best))
    stem = stem_of_other_law(problem, fits)
    if stem is not None and not (good and best is stem):
        return named(problem, [stem], fits, "adequate", rival)
    if good and (best.effect.hidden or stands(problem, best)):
        loud = beside_stem(problem, fits, catalogue) if best.effect.hidden else None
        if loud is not None:
            return named_pair(problem, loud, alternatives(problem, loud, catalogue), fits, rival)
        return named(problem, tied(fits), fits, "adequate", rival)
    pair = paired(problem, fits, catalogue, progress, rival)
    single = None if pair is None else enough_alone(problem, pair, fits)
    if single is not None:
        return told(problem, single, progress, catalogue, textured, legal, seed)
    better = pair is not None and pair.total < min(best.total - needed(problem), beyond)
    if pair is not None and better and adequate_pair(problem, pair, best):
        return named_pair(problem, pair, alternatives(problem, pair, catalogue), fits, rival)
    if good:
        return named(problem, tied(fits), fits, "adequate", rival)
    return unknown(problem, fits, rival)
