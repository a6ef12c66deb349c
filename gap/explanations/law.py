"""Decide whether a stem that is fitted with another effect sticks or only has play, which is stiction without a jump.

A play is meant where the jump gains next to nothing and the play leaves hardly anything of what the other effect leaves
alone: a play has one law.  What it leaves beyond that is friction of another law than the model's (``nesting``).
"""

from collections.abc import Sequence
from dataclasses import replace

from stickslip.gap.explanations.beside_noise import with_noise
from stickslip.gap.explanations.candidates import price
from stickslip.gap.explanations.nesting import HARDLY_BESIDE, RELEVANT, TIE
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.adequacy import scored_alone, share
from stickslip.gap.fits.hidden import followed_on
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Candidate, Fit, best_of, refined
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

WORTH = 0.6  # share of the gap that a pair with a play explains before it is followed


def with_its_law(problem: Problem, pair: Pair, catalogue: Sequence[Effect]) -> Pair:
    """Return a pair with a deadband in place of a stem whose jump gains nothing of relevance, and the other way round
    where what the deadband leaves of what the other effect leaves is too much for a play (``nesting``).
    """
    for stem, other in ((pair.first, pair.second), (pair.second, pair.first)):
        if not stem.effect.hidden:
            continue
        named = {one.name: one for one in catalogue}
        narrow = named.get(stem.effect.nests) if stem.effect.nests else None
        wide = next((one for one in catalogue if one.nests == stem.effect.name), None)
        if narrow is not None:
            new = _with_narrower(problem, pair, stem, other, narrow)
            return new if new is not None and _hardly(problem, new, other) else pair
        if wide is not None and not _hardly(problem, pair, other):
            candidate = Candidate(problem, inserted(problem.quiet, other), wide, stem.place)
            width = stem.values[stem.candidate.sizes[0]]
            start = candidate.tried([{candidate.sizes[0]: width}])
            if start:
                new = _beside_other(problem, refined(start[0]), other)
                return new if new is not None and new.second.F <= pair.second.F + TIE else pair
    return pair


def _with_narrower(problem: Problem, pair: Pair, stem: Fit, other: Fit, narrow: Effect) -> Pair | None:
    """Return a pair with a play in place of a stem if it leaves next to nothing more; None if not."""
    candidate = Candidate(problem, inserted(problem.quiet, other), narrow, stem.place)
    size, *jump = (stem.values[name] for name in stem.candidate.sizes)
    widths = [size - part * sum(jump) for part in (0.0, 0.5, 1.0)]
    start = best_of(candidate.tried([{candidate.sizes[0]: width} for width in widths]))
    if start is None or share(problem, start) < WORTH:
        return None
    new = _beside_other(problem, followed_on(start), other)
    near = TIE + RELEVANT * max(problem.score - problem.level, 0.0)
    return new if new is not None and near >= new.second.F - pair.second.F else None


def _beside_other(problem: Problem, stem: Fit, other: Fit) -> Pair | None:
    """Return a stem that has been fitted in the presence of another effect, and that effect, as a pair."""
    stem = replace(stem, price=price(stem))
    return with_noise(problem, stem, other) if other.candidate.noisy else Pair(other, stem)


def _hardly(problem: Problem, pair: Pair, other: Fit) -> bool:
    """Return whether a pair with a play leaves hardly anything of what its other effect leaves alone."""
    without = Candidate(problem, inserted(problem.quiet, other)).absent.F
    left = scored_alone(pair.second) - problem.level
    return left < HARDLY_BESIDE * max(without - problem.level, 1e-9)
