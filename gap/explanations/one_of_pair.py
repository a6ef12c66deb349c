"""One effect of a pair that does as well without the other: its search alone had ended elsewhere.

The sizes that a pair has found are tried for each of the two alone.  A second effect that is there costs more than
``needed`` nats to leave out, beside a stem 15 % of what that leaves; else there is one effect, not two.
"""

from collections.abc import Sequence

from stickslip.gap.explanations.pair import Pair
from stickslip.gap.explanations.pairs import GATE
from stickslip.gap.fits.adequacy import needed
from stickslip.gap.fits.search import Fit, best_of
from stickslip.gap.floors.problem import Problem


def enough_alone(problem: Problem, pair: Pair, fits: Sequence[Fit]) -> list[Fit] | None:
    """Return the single fits with one of a pair as the pair has it, the best first; None if the other one is needed."""
    for one in (pair.first, pair.second):
        alone = next((fit for fit in fits if (fit.effect.name, fit.place) == (one.effect.name, one.place)), None)
        if alone is None or one.effect.of_log or alone.candidate.noisy:
            continue
        sizes = {name: one.values[name] for name in alone.candidate.own}
        again = best_of(alone.candidate.tried([{**alone.values, **sizes}]))
        if again is None or again.total >= alone.total - needed(problem):
            continue
        # a stem's law is never exact, and some size of any effect takes away a little of what that leaves
        little = GATE * (again.F - problem.level) if one.effect.hidden else 0.0
        if again.total < pair.total + max(needed(problem), little):
            return sorted([again, *(fit for fit in fits if fit is not alone)], key=lambda fit: fit.total)
    return None
