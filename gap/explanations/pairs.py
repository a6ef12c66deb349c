"""Two effects at once, if one is not enough: pairs that linear fits propose, then a second effect with the best one."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.progress import Progress
from stickslip.gap.explanations.beside_noise import beside_noise
from stickslip.gap.explanations.candidates import candidates, price, ranked
from stickslip.gap.explanations.joint import apart, improved
from stickslip.gap.explanations.jumps import too_smooth
from stickslip.gap.explanations.law import with_its_law
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.explanations.proposals import SAME as ONE
from stickslip.gap.explanations.proposals import proposed, smooth
from stickslip.gap.explanations.stem_beside import stem_beside
from stickslip.gap.explanations.unmeasured import UnmeasuredLoad
from stickslip.gap.explanations.which_beside import which_beside
from stickslip.gap.fits.adequacy import needed, scored_alone, share
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Candidate, Fit, best_of, near_neutral, refined
from stickslip.gap.fits.sensitivity import promised
from stickslip.gap.fits.together import together
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

FIRSTS = 2  # single effects to which a second is added
ENOUGH = 0.3  # share of the gap that one of two effects explains alone
JOINED, FOLLOWED = 8, 3  # pairs that are fitted at once, a few steps, and to the end
WHOLE = 2  # of these on the whole record
PROMISING = 4  # smooth effects that are fitted beside a hidden mode in a large diagram
WORTH = 0.6  # share of the gap that two effects explain before they are fitted again in turn
GATE = 0.15  # of what a stem leaves, which a second effect takes away before the sizes of both are fitted at once
CLEARLY = 0.05  # share of the gap that a pair explains beyond one effect, for its sizes to be worth more
SAME = 60.0  # nats between effects that leave the same
USUAL = 1.5  # standard deviations of the score above its mean, within which two effects leave nothing
HOPE = 0.2  # of what one effect leaves, which a stem beside it takes away at the first look
STICKING = 0.88  # share of the gap that two effects explain, one of them a stem, whose law is never exact
TURNS = 2  # times that each is fitted again given the other


def paired(
    problem: Problem,
    fits: Sequence[Fit],
    catalogue: Iterable[Effect],
    progress: Progress = None,
    load: UnmeasuredLoad | None = None,
) -> Pair | None:
    """Return the best pair of effects; None if none could be replayed.  ``load``: what nobody measures, if any is.

    Pairs that lines propose are fitted at once; where none of them explains the record, an effect that has no slope is
    searched for in the presence of the best single ones, or any beside one with a hidden mode.
    """
    if not fits or share(problem, fits[0]) < ENOUGH:
        return None
    found = _worth_noise(problem, fits)
    if not any(_enough(problem, pair) for pair in found):
        found += joined(problem, fits)
    legal = list(catalogue)
    for first in [*_swapped(problem, found, fits[0]), *firsts(problem, fits)]:
        if any(_enough(problem, pair) for pair in found):
            break
        if first.effect.hidden and too_smooth(problem, first, load):
            continue
        second: Fit | None = None
        for pair in with_second(problem, first, legal, progress):
            worth = share(problem, pair.second) >= WORTH and _takes_away(problem, first, pair.second)
            found.append(improved(problem, pair) if worth else pair)
            second = found[-1].second
            if _enough(problem, found[-1]):
                break
        if first.effect.hidden or (second is not None and _enough(problem, found[-1])):
            continue
        sticky = stem_beside(problem, first, second, legal)
        if sticky is not None:
            found.append(sticky)
    best = min(found, key=lambda pair: pair.total, default=None)
    return None if best is None else with_its_law(problem, best, legal)


def _enough(problem: Problem, pair: Pair) -> bool:
    """Return whether no better pair need be looked for."""
    if pair.sticks and share(problem, pair.second) >= STICKING:
        return True
    return problem.limit + needed(problem) >= scored_alone(pair.second)


def _takes_away(problem: Problem, first: Fit, second: Fit) -> bool:
    """Return whether a second effect takes away enough of what a stem leaves alone; beside no stem any is worth it."""
    return not first.effect.hidden or GATE * (first.F - problem.level) <= first.F - second.F


def beside_stem(problem: Problem, fits: Sequence[Fit], catalogue: Iterable[Effect]) -> Pair | None:
    """Return the best effect, a stem that is good enough alone, with more noise of a sensor; None if there is none.

    What a stem of another law leaves is in few rows or in many beside one another, and has not the marks of noise.
    """
    found = [pair for pair in _worth_noise(problem, fits) if pair.first.effect.hidden]
    return with_its_law(problem, found[0], list(catalogue)) if found else None


def _worth_noise(problem: Problem, fits: Sequence[Fit]) -> list[Pair]:
    """Return pairs with more noise that gains something: a little takes away what another second effect leaves."""
    return [pair for pair in beside_noise(problem, fits) if pair.total < pair.first.total - needed(problem)]


def with_second(problem: Problem, first: Fit, catalogue: Sequence[Effect], progress: Progress) -> Iterator[Pair]:
    """Yield pairs of an effect and the best ones without a hidden mode beside it, none where none is there.

    Beside a stem, which lines do not hold for, the effects with slopes come first (``which_beside``), and the others
    only if none of these is enough: an offset stands in for much of a step.
    """
    rough, likely = _beside(problem, first, catalogue)
    if first.effect.hidden and problem.record.filter is None:
        for both in which_beside(problem, first, likely)[:1]:
            there = best_of(replace(both.candidate, problem=problem).tried([both.values]))
            if there is not None:
                yield apart(problem, there)
        likely = []
    for some in (likely, rough):
        best = next((fit for fit in ranked(some, progress) if fit.present), None)
        if best is not None:
            yield Pair(first, best)


def firsts(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    """Return the single effects to which a second is added: the best ones, one of those that leave the same.

    At most one of them sticks, because what is looked for beside it costs most.
    """
    found: list[Fit] = []
    for fit in fits:
        useful = fit.present and not fit.candidate.noisy and share(problem, fit) >= ENOUGH
        useful = useful and not (fit.effect.hidden and any(one.effect.hidden for one in found))
        if useful and all(abs(fit.F - one.F) > SAME for one in found):
            found.append(fit)
    return found[:FIRSTS]


def _swapped(problem: Problem, found: Sequence[Pair], best: Fit) -> list[Fit]:
    """Return the better one of the best pair of two, where it is clearly better than one effect, with its sizes there.

    Alone its sizes make up for the other effect; beside a stand-in they are right, and the other may be found.
    """
    pair = min(found, key=lambda one: one.total, default=None)
    if pair is None or pair.sticks or pair.second.candidate.noisy:
        return []
    if share(problem, pair.second) < max(WORTH, share(problem, best) + CLEARLY):
        return []
    alone = [replace(fit.candidate, base=problem.quiet).tried([fit.values]) for fit in (pair.first, pair.second)]
    one = best_of([fit for fits in alone for fit in fits])
    return [] if one is None else [replace(one, price=price(one))]


def _beside(problem: Problem, first: Fit, catalogue: Sequence[Effect]) -> tuple[list[Candidate], list[Candidate]]:
    """Return the effects that are searched for in the presence of another: those that have no slope, for which no line
    speaks, and beside a hidden mode the others, of a large diagram the few that promise most by slopes.
    """
    legal = [
        one
        for one in candidates(problem, inserted(problem.quiet, first), catalogue)
        if not (one.effect is first.effect and one.place == first.place)
        and not (one.effect and one.effect.hidden)
        and not one.noisy  # which has been tried beside all of them
    ]
    rough = [one for one in legal if not smooth(one)]
    if not first.effect.hidden:
        return rough, []
    likely = [one for one in legal if smooth(one)]
    if problem.record.filter is None:
        return rough, _unlike(problem, likely)
    likely.sort(key=lambda one: promised(replace(one, problem=problem.early)), reverse=True)
    return rough, _unlike(problem, likely)[:PROMISING]


def _unlike(problem: Problem, ordered: Sequence[Candidate]) -> list[Candidate]:
    """Return one of all effects that are the same to the record, the first of them; its class is listed in the end."""
    kept: list[Candidate] = []
    slopes: list[NDArray[np.float64]] = []
    for one in ordered:
        slope = near_neutral(replace(one, problem=problem.early))
        if slope is not None:
            own = np.nan_to_num(slope)
            own = own / max(float(np.linalg.norm(own)), 1e-300)
            if any(abs(float(own @ other)) > ONE for other in slopes):
                continue
            slopes.append(own)
        kept.append(one)
    return kept


def joined(problem: Problem, fits: Sequence[Fit]) -> list[Pair]:
    """Return pairs that lines propose, the sizes of both effects fitted at once, the best pair first.

    They are fitted on the first part of the record where that shows the gap, and the best of them on the whole.  No
    line holds for a stem that sticks.
    """
    found: list[Fit] = []
    legal = [one for one in proposed(problem, fits) if not any(c.effect and c.effect.hidden for c in one.both)]
    last = math.inf
    for one in legal[:JOINED]:
        if last < one.F:
            break
        candidate = together(*(replace(c, problem=problem.early) for c in one.both))
        if candidate is not None:
            best = best_of(candidate.tried(one.starts))
            if best is not None:
                found.append(refined(best, 3))
                if _usual(problem.early) >= found[-1].F:  # the first part may not tell it from its like
                    last = min(last, one.F + SAME)
    found.sort(key=lambda fit: fit.F)
    done = sorted((refined(fit) for fit in found[:FOLLOWED]), key=lambda fit: fit.F)
    if problem.early is not problem:
        whole = [replace(fit.candidate, problem=problem).tried([fit.values]) for fit in done[:WHOLE]]
        done = [refined(fit, 3) for fits in whole for fit in fits]
    return sorted((apart(problem, fit) for fit in done), key=lambda pair: pair.total)


def _usual(problem: Problem) -> float:
    """Return the score that most records without a gap do not exceed: a pair that leaves so little needs no other."""
    return problem.level + USUAL * problem.floor.sd * math.sqrt(problem.known)
