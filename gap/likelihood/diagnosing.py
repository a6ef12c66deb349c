"""Diagnose a record by one likelihood: one effect, or two where none is enough alone."""

from collections.abc import Sequence
from dataclasses import replace

from stickslip.diagram.progress import Progress
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.beside import as_part, with_effect
from stickslip.gap.likelihood.digits import shows_steps
from stickslip.gap.likelihood.explained import STEM_TIE, TIE, Outcome, explained, undistinguished
from stickslip.gap.likelihood.fit import Fit, tried, unfitted
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.judge import MOST_LEFT, enough, judged
from stickslip.gap.likelihood.left import left, level
from stickslip.gap.likelihood.logged_stem import LoggedStem
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.search import (
    price,
)
from stickslip.gap.likelihood.settling import settled
from stickslip.gap.null_model.null_model import measured

DIGIT_RUNS = 12  # of the model with a sensor of few levels
UNLIKE = 0.1  # share of their usual loss that a second effect gains: another program meets levels at other instants


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
        alone = explained(frame, stem.possible(catalogue), seed, progress)
        if not stem.follows and not alone.named:  # it is elsewhere, whatever else the log shows
            alone = replace(alone, gap=True)
        return replace(alone, stem=stem)
    alone = explained(frame, catalogue, seed, progress)
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


def _promising(alone: Outcome) -> bool:
    """Return whether the best effect gains what the largest figure that the model leaves promises: T^2/2 nats for T
    standard deviations.  Of two causes the larger one does; where none does the catalogue has not what left it.
    """
    return alone.null.nll - alone.fits[0].nll > 0.5 * min(alone.alone.size, MOST_LEFT) ** 2


def _with_second(first: Fit, catalogue: Sequence[Effect], seed: int, progress: Progress) -> Outcome | None:
    """Return what explains a record beside a first effect, None if nothing can be beside it."""
    stems = [effect for effect in catalogue if effect.hidden]
    if first.hypothesis.sticks and first.hypothesis.frame.replays:  # two stems at once are not looked for
        catalogue = [effect for effect in catalogue if effect not in stems]
    if first.hypothesis.hides:
        others = explained(with_effect(first), [effect for effect in catalogue if effect not in stems], seed, progress)
        part = as_part(others.fits[0], first) if others.fits else None
        if part is None:
            return None
        first, catalogue = part, stems
    both = explained(with_effect(first), catalogue, seed, progress)
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
    return replace(alone, fits=fits, best=best, named=undistinguished(fits, alone.null))


def _pair(alone: Outcome, both: Outcome) -> Outcome:
    """Return that two effects explain a record."""
    same = [f for f in alone.fits if 0.0 <= price(f) - price(both.firsts[0]) <= TIE and not f.hypothesis.hides]
    return replace(both, null=alone.null, alone=alone.alone, firsts=same or both.firsts)


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

    Through them nothing has slopes. Records of another program lay up to 6 % above the loss that they make.
    """
    first = alone.fits[0]
    model = first.hypothesis.model(first.best.values)
    null_model, logs = measured(model, frame.quiet, frame.record, DIGIT_RUNS, seed + 1)
    if len(logs) < DIGIT_RUNS // 2:
        return alone
    others = [effect for effect in catalogue if effect is not first.hypothesis.effect]
    both = explained(replace(frame, null_model=null_model), others, seed, progress)
    if not both.named or both.null.nll - price(both.named[0]) <= UNLIKE * abs(level(both.null.best)):
        return alone
    return replace(both, firsts=(first,))
