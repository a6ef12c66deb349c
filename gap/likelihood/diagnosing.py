"""Diagnose a record by one likelihood: the model alone, every effect, and whether the best of them is enough."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress
from stickslip.gap.floors.floor import measured, settling_rows
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.beside import as_part, with_effect
from stickslip.gap.likelihood.candidates import Candidate, by_race, by_score
from stickslip.gap.likelihood.digits import by_digits, shows_steps
from stickslip.gap.likelihood.felt import felt
from stickslip.gap.likelihood.fit import Fit, tried, unfitted
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.inputs import rounded
from stickslip.gap.likelihood.judge import MOST_LEFT, enough, judged
from stickslip.gap.likelihood.left import left, level
from stickslip.gap.likelihood.logged_stem import LoggedStem
from stickslip.gap.likelihood.nesting import one_of_nested
from stickslip.gap.likelihood.phase import in_phase
from stickslip.gap.likelihood.prepared import NoFilter
from stickslip.gap.likelihood.relevance import RELEVANT, moved
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.rivals import beside_random, likelier
from stickslip.gap.likelihood.scores import at_bound
from stickslip.gap.likelihood.search import (
    LAGGING,
    fitted,
    free_parameters,
    legal,
    model_alone,
    price,
    schwarz,
)
from stickslip.gap.likelihood.settling import SETTLING, settled
from stickslip.gap.likelihood.switches import with_ramps, with_switches
from stickslip.gap.likelihood.unmeasured import ALLOWED, UnmeasuredLoad, unmeasured_load
from stickslip.gap.likelihood.verdict import Verdict
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import nuisances, silenced
from stickslip.gap.records.record import Record
from stickslip.gap.records.regular import without_unsettled
from stickslip.gap.records.start import start_values

ODDS = 10.0  # to one, for an effect against none
ROUGHLY = 4.0  # nats by which a fit may gain more than its score promises
TIE = 3.0  # nats by which an explanation may lag behind the best, and still be named with it
STEM_TIE = 8.0  # nats to which a bank of stems is sure: the same sizes with gains of other paths differed by as much
DIGIT_RUNS = 12  # of the model with a sensor of few levels
UNLIKE = 0.1  # share of their floor that a second effect gains: another program meets levels at other instants
MOST_BLOCKS, MOST_STATES = 14, 60  # of a diagram that bends; larger ones have an observer of their own


@dataclass(frozen=True, eq=False)
class Outcome:
    """What was found: ``null`` the model alone, ``alone`` how unusual what it leaves is; ``fits`` of effects, the
    likeliest first, ``best`` how unusual what the first leaves is; ``gap`` whether there is one, ``named`` the fits
    that the record does not tell apart, none where none is enough; ``share`` by
    which the first fit moves the signals; ``textured`` whether the digits of the log told; ``firsts`` the effects, not
    told apart, one of which is part of the model of all fits: the gap has two causes; ``stem`` what a logged stem says;
    ``looked`` first sizes of all effects; ``rival`` the load that suits a replayed record best in place of any effect.
    """

    null: Fit
    alone: Verdict
    fits: Sequence[Fit]
    best: Verdict | None
    gap: bool
    named: Sequence[Fit]
    share: float = 1.0
    textured: bool = False
    firsts: Sequence[Fit] = ()
    stem: LoggedStem | None = None
    looked: Sequence[Candidate] = ()
    rival: UnmeasuredLoad | None = None


def frame_of(model: Diagram, record: Record, asked: bool = True) -> Frame | None:
    """Return what the hypotheses of a record share; None where no filter follows the model.

    ``asked``: whether the filter is run to see that it does; who runs it anyhow sees an ``ArithmeticError``.

    The filter is for models with loads that nobody measures: without any, a pinned replay leaves nothing to estimate.
    """
    if not any(one.correlation_time > 0.0 for one in nuisances(model)):
        return None
    quiet = silenced(model)
    record = settled_behind_holes(quiet, record)
    frames = (Frame(Given(model.starting_at(start)), record) for start in (start_values(quiet, record), {}))
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
        if asked:
            alone.filtered({})
    except ArithmeticError:
        return None
    return alone.frame


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


def worth(one: Candidate, rows: float) -> float:
    """Return what an effect promises beyond what its parameters cost [nats], in a record of so many values."""
    return one.gain - schwarz(free_parameters(one), rows)


def needed(found: Sequence[Candidate]) -> float:
    """Return how many nats make an effect a gap by itself: the choice among all costs some, and odds of ``ODDS``."""
    return math.log(max(len(found), 1)) + math.log(ODDS)


def outcome(
    frame: Frame, catalogue: Sequence[Effect], seed: int = 0, progress: Progress = None, stem: LoggedStem | None = None
) -> Outcome:
    """Return what explains a record: an effect, or two where none is enough alone, the best single one among them.

    ``stem`` is what a logged stem says, which decides what can be.  Where a measurement has few levels, and the
    catalogue no coarse sensor, nothing is enough.
    """
    found = _likeliest(frame, catalogue, seed, progress, stem)
    if found.named and not found.textured and shows_steps(found.null):
        return replace(found, named=(), firsts=())
    return found


def _likeliest(
    frame: Frame, catalogue: Sequence[Effect], seed: int, progress: Progress, stem: LoggedStem | None
) -> Outcome:
    """Return what explains a record best, whatever its digits show."""
    if stem is not None:
        alone = _explained(frame, stem.possible(catalogue), seed, progress)
        if not stem.follows and not alone.named:  # it is elsewhere, whatever else the log shows
            alone = replace(alone, gap=True)
        return replace(alone, stem=stem)
    alone = _explained(frame, catalogue, seed, progress)
    if alone.textured and isinstance(frame, Replays) and not _of_log(alone.fits[0]):
        return _beside_digits(frame, alone, catalogue, seed, progress)
    partly = bool(alone.named) and frame.replays and alone.best is not None and alone.best.unusual
    if not alone.gap or (alone.named and not partly) or not alone.fits or not _promising(alone):
        return alone
    both = _with_second(alone.fits[0], catalogue, seed, progress)
    if both is None:
        return alone
    both = _without_jump(frame, both, catalogue)
    if partly:  # the effect explains nearly all, and what it leaves may be another's, or its law's
        return alone if not both.named or (both.best is not None and both.best.unusual) else _pair(alone, both)
    single = _single(alone, both, seed)
    if single is not None or not both.named:
        return single or alone
    return _pair(alone, both)


def _without_jump(frame: Frame, both: Outcome, catalogue: Sequence[Effect]) -> Outcome:
    """Return two effects of a replay; the first, a stem that hardly jumps beside the second, as one that does not."""
    first = both.firsts[0].hypothesis
    narrow = next((one for one in catalogue if one.name == first.nests), None)
    if narrow is None or not frame.replays or not both.named:
        return both
    second = both.named[0]
    part = second.hypothesis.frame.given.part
    assert part is not None
    sizes = list(part.now(second.best.values).values())
    plain = tried(
        Hypothesis(both.firsts[0].hypothesis.frame, narrow, first.place), {_size(narrow): sizes[0] - sizes[1]}
    )
    if plain is None:
        return both
    one = replace(second.hypothesis, frame=with_effect(unfitted(plain)))
    start = tried(one, {name: second.best.values[name] for name in one.own})
    again = None if start is None else settled(unfitted(start))
    if again is None or left(again.best) > left(second.best) + STEM_TIE:
        return both
    return replace(both, named=(again, *both.named[1:]), fits=(again, *both.fits[1:]), firsts=(unfitted(plain),))


def _size(effect: Effect) -> str:
    return effect.parameters[0].name


def _of_log(fit: Fit) -> bool:
    effect = fit.hypothesis.effect
    return effect is not None and effect.of_log


def _beside_digits(
    frame: Replays, alone: Outcome, catalogue: Sequence[Effect], seed: int, progress: Progress
) -> Outcome:
    """Return what explains a record beside a sensor of few levels, which digits prove: these levels count as noise.

    Through them nothing has slopes. Records of another program lay up to 6 % above the floor that they make.
    """
    first = alone.fits[0]
    model = first.hypothesis.model(first.best.values)
    floor, logs = measured(model, frame.quiet, frame.record, DIGIT_RUNS, seed + 1)
    if len(logs) < DIGIT_RUNS // 2:
        return alone
    others = [effect for effect in catalogue if effect is not first.hypothesis.effect]
    both = _explained(replace(frame, floor=floor), others, seed, progress)
    if not both.named or both.null.nll - price(both.named[0]) <= UNLIKE * abs(level(both.null.best)):
        return alone
    return replace(both, firsts=(first,))


def _pair(alone: Outcome, both: Outcome) -> Outcome:
    """Return that two effects explain a record."""
    same = [f for f in alone.fits if 0.0 <= price(f) - price(both.firsts[0]) <= TIE and not f.hypothesis.hides]
    return replace(both, null=alone.null, alone=alone.alone, firsts=same or both.firsts)


def _promising(alone: Outcome) -> bool:
    """Return whether the best effect gains what the largest figure that the model leaves promises: T^2/2 nats for T
    standard deviations.  Of two causes the larger one does; where none does the catalogue has not what left it.
    """
    return alone.null.nll - alone.fits[0].nll > 0.5 * min(alone.alone.size, MOST_LEFT) ** 2


def _with_second(first: Fit, catalogue: Sequence[Effect], seed: int, progress: Progress) -> Outcome | None:
    """Return what explains a record beside a first effect, None if nothing can be beside it."""
    stems = [effect for effect in catalogue if effect.hidden]
    if first.hypothesis.hides:
        others = _explained(with_effect(first), [effect for effect in catalogue if effect not in stems], seed, progress)
        part = as_part(others.fits[0], first) if others.fits else None
        if part is None:
            return None
        first, catalogue = part, stems
    both = _explained(with_effect(first), catalogue, seed, progress)
    return replace(both, firsts=(first,))


def _single(alone: Outcome, both: Outcome, seed: int) -> Outcome | None:
    """Return that one of two effects explains the record alone; None if none does.

    Its size beside another, or beside none where all is fitted once more, may be one to which the first search did not
    come: the first effect where nothing unusual is left beside it, else the second.
    """
    found = both.named[0] if both.named else both.null
    one, part = found.hypothesis, found.hypothesis.frame.given.part
    if one.hides or part is None or (both.gap and not both.named):
        return None
    if one.effect is not None:
        effect, place, own = one.effect, one.place, {name: found.best.values[name] for name in one.own}
    else:
        effect, place, own = part.effect, part.place, part.now(found.best.values)
    frame = replace(found.hypothesis.frame, given=alone.null.hypothesis.frame.given)  # inputs switch as suits it
    free = {key: found.best.values[key] for key in frame.free}
    start = tried(Hypothesis(frame, effect, place), {**free, **own})
    if start is None:
        return None
    fit = settled(unfitted(start))
    pays = price(both.firsts[0]) - both.firsts[0].nll  # for the sizes of the first, which are free in both
    if price(fit) > min(price(found) + pays + TIE, price(alone.fits[0])):
        return None
    best = judged(fit, [], seed, alone.null)
    if not enough(fit, best, alone.alone, alone.null):
        return None
    fits = (fit, *alone.fits)
    return replace(alone, fits=fits, best=best, named=_not_told_apart(fits))


def _explained(frame: Frame, catalogue: Sequence[Effect], seed: int, progress: Progress) -> Outcome:
    """Return which single effect explains a record, beside what is part of the model already."""
    frame = when_switched(frame)
    rough = model_alone(replace(frame, apart=True))
    null = settled(rough)
    alone = judged(null, [], seed)
    shown = by_digits(null, alone, catalogue, seed)
    if shown is not None:
        return Outcome(null, alone, (shown,), None, True, (shown,), textured=True)
    far = null.best.gross or bool(at_bound(null))  # noise that wants to be larger than it can be hides how far it is
    found = (
        by_race(null, rough, legal(rough, catalogue), progress)
        if far
        else by_score(null, legal(null, catalogue), progress)
    )
    values = float(np.isfinite(null.best.judged).sum())
    calm = not alone.unusual and all(worth(c, values) + ROUGHLY < needed(found) for c in found)
    # scores say little of what hides a mode
    chosen = [c for c in found if c.hypothesis.hides] if calm else found
    # a model that leaves nothing unusual is no worse than a stem of about the right size
    within = math.inf if alone.unusual else null.nll + LAGGING
    fits = fitted(null, chosen, far, within, progress)
    fits = one_of_nested(fits, null) if frame.replays else fits
    gap = alone.unusual or (bool(fits) and null.nll - price(fits[0]) > needed(found))
    if not gap or not fits:
        return Outcome(null, alone, fits, None, gap, (), looked=found)
    mine = fits[0].hypothesis
    beside = [c for c in found if (c.hypothesis.effect, c.hypothesis.place) != (mine.effect, mine.place)]
    best = judged(fits[0], [] if far else beside, seed, null)  # far from the log no direction is right
    rival = unmeasured_load(null) if isinstance(frame, Replays) else None
    good = price(fits[0]) < null.nll and enough(fits[0], best, alone, null)
    if rival is not None and best.unusual:  # what leaves something has to be likelier than a load of any spectrum
        good = good and null.nll - price(fits[0]) > rival.gained + ALLOWED
    if good:
        best = beside_random(fits[0], best)
        unsure = STEM_TIE if mine.hides else TIE
        good = enough(fits[0], best, alone, null) and (frame.replays or not likelier(fits[0], null, unsure))
    share = moved(mine, fits[0].best.values, seed) if good or not alone.unusual else 1.0
    if share < RELEVANT:
        return Outcome(null, alone, fits, None, False, (), share, looked=found)
    return Outcome(null, alone, fits, best, gap, _not_told_apart(fits) if good else (), rival=rival)


def _not_told_apart(fits: Sequence[Fit]) -> Sequence[Fit]:
    """Return the first fit, and those that the record does not tell from it, the likeliest first."""
    same = [fit for fit in fits if price(fit) <= price(fits[0]) + TIE]
    near = [
        fit for fit in fits if price(fit) <= price(fits[0]) + STEM_TIE and _nested(fit, fits[0]) and fit not in same
    ]
    return [*same, *near]


def _nested(one: Fit, other: Fit) -> bool:
    """Return whether one of two effects at one place nests the other."""
    a, b = one.hypothesis.effect, other.hypothesis.effect
    if a is None or b is None or one.hypothesis.place != other.hypothesis.place:
        return False
    return a.nests == b.name or b.nests == a.name
