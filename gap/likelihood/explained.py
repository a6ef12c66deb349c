"""Which single effect explains a record: the model alone, every effect, and whether the best of them is enough."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.diagram.progress import Progress
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.candidates import Candidate, by_race, by_score
from stickslip.gap.likelihood.digits import by_digits
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.framing import when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.judge import enough, gained_by_chance, judged
from stickslip.gap.likelihood.left import GAINED, allowed
from stickslip.gap.likelihood.logged_stem import LoggedStem
from stickslip.gap.likelihood.nesting import RELEVANT, nested, one_of_nested
from stickslip.gap.likelihood.relevance import least, moved
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
from stickslip.gap.likelihood.settling import settled
from stickslip.gap.likelihood.unmeasured import UnmeasuredLoad, unmeasured_load
from stickslip.gap.likelihood.verdict import Verdict

ODDS = 10.0  # to one, for an effect against none
ROUGHLY = 4.0  # nats by which a fit may gain more than its score promises
TIE = 3.0  # nats by which an explanation may lag behind the best, and still be named with it
STEM_TIE = 8.0  # nats to which a bank of stems is sure: the same sizes with gains of other paths differed by as much


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
    candidates: Sequence[Candidate] = ()
    rival: UnmeasuredLoad | None = None


def worth(one: Candidate, rows: float) -> float:
    """Return what an effect promises beyond what its parameters cost [nats], in a record of so many values."""
    return one.gain - schwarz(free_parameters(one), rows)


def needed(found: Sequence[Candidate]) -> float:
    """Return how many nats make an effect a gap by itself: the choice among all costs some, and odds of ``ODDS``."""
    return math.log(max(len(found), 1)) + math.log(ODDS)


def explained(frame: Frame, catalogue: Sequence[Effect], seed: int, progress: Progress) -> Outcome:
    """Return which single effect explains a record, beside what is part of the model already."""
    frame = when_switched(frame)
    rough = model_alone(replace(frame, apart=True))
    null = settled(rough)
    alone = judged(null, [], seed)
    shown = by_digits(null, alone, catalogue, seed)
    if shown is not None:
        return Outcome(null, alone, (shown,), None, True, (shown,), textured=True)
    far = null.best.gross or bool(at_bound(null))  # noise that wants to be larger than it can be hides how far it is
    found = _candidates(null, rough, catalogue, far, progress)
    values = float(np.isfinite(null.best.judged).sum())
    roughly = ROUGHLY + _taken(null)
    calm = not alone.unusual and all(worth(c, values) + roughly < needed(found) for c in found)
    # scores say little of what hides a mode
    chosen = [c for c in found if c.hypothesis.hides] if calm else found
    # a model that leaves nothing unusual is no worse than a stem of about the right size
    within = math.inf if alone.unusual else null.nll + LAGGING
    fits = fitted(null, chosen, far, within, progress)
    fits = one_of_nested(fits, null) if frame.replays else fits
    steady = frame.replays or not null.best.kinks.any()
    gains = bool(fits) and (
        (alone.unusual and steady) or null.nll - price(fits[0]) > _least_gain(fits[0], null, found, seed)
    )
    gap = alone.unusual or gains
    if not gap or not fits:
        return Outcome(null, alone, fits, None, gap, (), candidates=found)
    mine = fits[0].hypothesis
    beside = [c for c in found if (c.hypothesis.effect, c.hypothesis.place) != (mine.effect, mine.place)]
    best = judged(fits[0], [] if far else beside, seed, null)  # far from the log no direction is right
    rival = unmeasured_load(null) if isinstance(frame, Replays) else None
    good = gains and price(fits[0]) < null.nll and enough(fits[0], best, alone, null)
    if rival is not None and best.unusual:  # what leaves something has to be likelier than a load of any spectrum
        good = good and null.nll - price(fits[0]) > rival.gained + GAINED
    if good:
        best = beside_random(fits[0], best)
        unsure = STEM_TIE if mine.hides else TIE
        good = enough(fits[0], best, alone, null) and (frame.replays or not likelier(fits[0], null, unsure))
    share = moved(mine, fits[0].best.values, seed) if good or not alone.unusual else 1.0
    if share < least(frame):
        return Outcome(null, alone, fits, None, False, (), share, candidates=found)
    return Outcome(null, alone, fits, best, gap, undistinguished(fits, null) if good else (), rival=rival)


def _taken(null: Fit) -> float:
    """Return what noise and loads gain by other sizes than the stated ones [nats].

    An effect may gain it in their place.  Scores do not know, since they compare with the sizes that are fitted.
    """
    one = null.hypothesis
    stated = None if one.frame.replays else tried(one, {**null.best.values, **one.frame.stated})
    return 0.0 if stated is None else max(stated.nll - null.nll, 0.0)


def _least_gain(fit: Fit, null: Fit, found: Sequence[Candidate], seed: int) -> float:
    """Return how many nats make an effect a gap where the model alone leaves nothing unusual, or loses its way."""
    frame = null.hypothesis.frame
    if not isinstance(frame, Replays):
        return needed(found) + (gained_by_chance(fit, null, seed) if null.best.kinks.any() else 0.0)
    # another integrator, and rows between scans, cost as much
    return allowed(frame) + gained_by_chance(fit, null, seed)


def _candidates(
    null: Fit, rough: Fit, catalogue: Sequence[Effect], far: bool, progress: Progress
) -> Sequence[Candidate]:
    """Return a first size of every effect, the best first."""
    frame = null.hypothesis.frame
    if isinstance(frame, Replays) and frame.record.filter is not None:  # whose own runs between rows take long
        alone = tried(Hypothesis(frame.quick), null.best.values)
        quick = null if alone is None else replace(null, best=alone)
        return by_score(quick, legal(quick, catalogue), progress)
    if far:
        return by_race(null, rough, legal(rough, catalogue), progress)
    return by_score(null, legal(null, catalogue), progress)


def undistinguished(fits: Sequence[Fit], null: Fit) -> Sequence[Fit]:
    """Return the first fit, and those that the record does not tell from it, the likeliest first.

    A jump of a stem that explains hardly anything of the gap beyond a play is not told from none.
    """
    same = [fit for fit in fits if price(fit) <= price(fits[0]) + TIE]
    hardly = max(STEM_TIE, RELEVANT * (null.nll - fits[0].nll))
    near = [fit for fit in fits if price(fit) <= price(fits[0]) + hardly and nested(fit, fits[0]) and fit not in same]
    return [*same, *near]
