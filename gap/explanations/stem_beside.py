"""A stem that sticks together with another effect: both are fitted at once, because each alone compensates for the
other.

1. A grid over the stem's sizes, each judged by what slopes of the other effect leave of it, on the first part.  Where
   that is about as much as without a stem, there is none.
2. From the best troughs steps along the slopes of both, with wrong modes set right, then patterns of the stem's sizes.
3. Steps along the slopes of both on the whole record.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.explanations.candidates import candidates, price
from stickslip.gap.explanations.joint import apart, improved, in_turn, pursued, stepped
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.hidden import Lines, first_part_of, glimpsed, glimpsed_beside
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Candidate, Fit, best_of, slopes
from stickslip.gap.fits.together import marked, together
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

HOPE = 0.2  # of what one effect leaves, which a stem beside it takes away at the first look
HARDLY = 0.05  # of what one effect leaves: where another than a stem leaves no more, none is looked for
PROMISED = 0.65  # of what one effect leaves of the first part, which a stem in the best trough leaves at most
TROUGHS, ROUNDS = 4, 4  # that are followed, and steps in each
WIDTHS = (0.15, 0.07)  # of patterns on the first part, relative to a size


def stem_beside(problem: Problem, first: Fit, second: Fit | None, catalogue: Sequence[Effect]) -> Pair | None:
    """Return the simplest adequate effect with a hidden mode together with another effect; None if there is none.

    It is looked for on the first part of the record, and followed where it does better than ``second``.
    """
    base = inserted(problem.quiet, first)
    legal = [one for one in candidates(problem, base, catalogue) if one.effect and one.effect.hidden]
    least = min(first.F, second.F if second else first.F)
    left = max(first.F - problem.level, 0.0)
    if least - problem.level < HARDLY * left:
        return None
    best: Pair | None = None
    for candidate in sorted(legal, key=lambda one: len(one.own)):
        pair = _both(problem, first, candidate)
        if pair is not None and least - HOPE * left > pair.second.F:
            pair = improved(problem, pair)
            if best is None or pair.total < best.total:
                best = pair
            least = min(least, pair.second.F)
    return best


def _both(problem: Problem, first: Fit, stem: Candidate) -> Pair | None:
    """Return a first look at a stem beside another effect, on the whole record."""
    own = Candidate(problem, problem.quiet, first.effect, first.place)

    plain, head = first_part_of(problem, modes=False), first_part_of(problem, modes=True)
    (there,) = replace(own, problem=plain).tried([first.values])
    J, names = slopes(there)  # a step that comes later is not felt there
    at = np.array([first.values[name] for name in names])
    low, high = np.array([own.bounds[name] for name in names]).reshape(-1, 2).T
    lines: Lines = J, np.minimum(low - at, 0.0), np.maximum(high - at, 0.0)
    troughs = glimpsed_beside(stem, lines)[:TROUGHS]
    if troughs and troughs[0].F - plain.level > PROMISED * (there.F - plain.level):
        return None
    starts = []
    for one in troughs:
        moved = {name: first.values[name] + float(change) for name, change in zip(names, one.moved, strict=True)}
        starts.append({**marked({**first.values, **moved}, "1."), **marked(one.sizes, "2.")})
    both = together(replace(own, problem=head), replace(stem, problem=head, base=problem.quiet))
    if both is None or not starts:
        fit = glimpsed(stem)
        return None if fit is None else Pair(first, replace(fit, price=price(fit)))
    found = best_of(pursued(both.tried(starts), lambda fit: stepped(fit, ROUNDS)))
    return None if found is None else _on(problem, in_turn(found, WIDTHS))


def _on(problem: Problem, both: Fit) -> Pair | None:
    """Return a pair with the sizes of a joint fit, on the whole record."""
    there = best_of(replace(both.candidate, problem=problem).tried([both.values]))
    return None if there is None else apart(problem, there)
