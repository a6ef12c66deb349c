"""Sizes of two effects fitted at once, and such a fit taken apart into the two."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from stickslip.gap.explanations.candidates import price
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.adequacy import share
from stickslip.gap.fits.hidden import patterned
from stickslip.gap.fits.inserting import begun
from stickslip.gap.fits.search import ROUNDS, Candidate, Fit, best_of, refined
from stickslip.gap.fits.together import Together, marked, together, values_of
from stickslip.gap.floors.problem import Problem

CLEAN = 0.95  # share of the gap up to which the sizes of a stem are followed by patterns, too
WIDTHS = (0.05, 0.02)  # of patterns on the whole record, relative to a size
BEHIND = 1.5  # times what the best one that was followed leaves, which another leaves before, at most
PATTERNS, STEPS = 4, 3  # of a width, and steps along slopes behind them
HARDLY = 0.03  # of what is left: where a width gains less, a narrower one is not tried


def apart(problem: Problem, fit: Fit) -> Pair:
    """Return the two effects of a joint fit, each as a fit in the presence of the other."""
    both = fit.effect
    if not isinstance(both, Together):
        raise TypeError(f"{both!r} is one effect, not two")
    (_, one, first_place), (_, two, second_place) = both.parts
    values = values_of(fit, "1."), values_of(fit, "2.")
    bases = [
        begun(problem, problem.quiet, effect, place, {p.name: own[p.name] for p in effect.parameters})
        for effect, place, own in ((two, second_place, values[1]), (one, first_place, values[0]))
    ]
    made = [
        Fit(Candidate(problem, base, effect, place), own, fit.F, fit.e, charge=fit.charge)
        for base, effect, place, own in zip(bases, (one, two), (first_place, second_place), values, strict=True)
    ]
    first, second = (replace(part, price=price(part)) for part in made)
    return Pair(first, second)


def improved(problem: Problem, pair: Pair) -> Pair:
    """Return a pair with the sizes of both fitted at once; those of a stem are followed by patterns besides."""
    both = together(*(replace(fit.candidate, problem=problem) for fit in (pair.first, pair.second)))
    start = both.tried([{**marked(pair.first.values, "1."), **marked(pair.second.values, "2.")}]) if both else []
    if not start:
        return pair
    fit = stepped(start[0], ROUNDS) if pair.sticks else refined(start[0])
    found = apart(problem, in_turn(fit, WIDTHS) if pair.sticks else fit)
    return found if found.total < pair.total else pair


def pursued(starts: Sequence[Fit], follow: Callable[[Fit], Fit]) -> list[Fit]:
    """Return what following the starts comes to, the best start first, until one is far behind what has been found."""
    found: list[Fit] = []
    for fit in sorted(starts, key=lambda fit: fit.F):
        level = fit.candidate.problem.level
        nearest = min((one.F for one in found), default=math.inf) - level
        if fit.F - level > BEHIND * nearest:
            break
        found.append(follow(fit))
    return found


def in_turn(both: Fit, widths: Sequence[float]) -> Fit:
    """Return a joint fit after patterns of the stem's sizes, of these first widths, and steps of all sizes, in turn.

    One slip that is missed has no slope, and a stem's sizes that are 1 % off miss many.
    """
    problem = both.candidate.problem
    for wide in widths:
        if share(problem, both) >= CLEAN:
            break
        pair = apart(problem, both)
        stem, mark = (pair.first, "1.") if pair.first.effect.hidden else (pair.second, "2.")
        moved = patterned(stem, wide, PATTERNS)
        again = both.candidate.tried([{**both.values, **marked(moved.values, mark)}])
        before, both = both, best_of([both, *(stepped(one, STEPS) for one in again)]) or both
        if HARDLY * (before.F - problem.level) > before.F - both.F:
            break
    return both


def stepped(both: Fit, rounds: int) -> Fit:
    """Return a joint fit after steps of the sizes in which a score is smooth, then of the stem's too.

    Wrong sizes of the other effect call for modes that are wrong, so they are fitted first with modes as replays have
    them: there a stem is wrong between some slips only, and the rows between the others tell.
    """
    parts = both.effect.parts if isinstance(both.effect, Together) else ()
    smooth = [name for mark, one, _ in parts if not one.hidden for name in both.values if name.startswith(mark)]
    plain = replace(both.candidate, problem=replace(both.candidate.problem, modes=False))
    begun_at = [refined(one, rounds, smooth) for one in plain.tried([both.values])]
    again = both.candidate.tried([one.values for one in begun_at])
    return best_of([refined(one, rounds) for one in (both, *again)]) or both
