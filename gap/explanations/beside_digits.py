"""A second effect, added to one that the digits of a log prove, such as a sensor that gives multiples of a step.

Through a sensor of few levels nothing has slopes.  So its levels count as noise: the model without it is judged by the
floor that runs of the model with it have, and what lies above that floor is the second effect's.  Records of another
program, through a sensor of a level each 5 % of span, lay up to 6 % above it; fits of small effects gained up to 7 %.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from stickslip.diagram.progress import Progress
from stickslip.gap.explanations.candidates import candidates, ranked
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.adequacy import adequate, complete, needed
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.floor import measured
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

RUNS = 12  # of the model with the first effect
UNLIKE = 0.1  # share of that floor which a second effect must gain: another program meets the levels at other instants


@dataclass(frozen=True, eq=False)
class Beside:
    """``problem`` in which the levels of a sensor are noise, the ``pair``, and all ``fits`` of a second effect."""

    problem: Problem
    pair: Pair
    fits: tuple[Fit, ...]


def beside_digits(
    problem: Problem, first: Fit, catalogue: Iterable[Effect], seed: int, progress: Progress = None
) -> Beside | None:
    """Return the pair of an effect that digits prove and a second one; None if nothing remains or no effect fits."""
    model = inserted(problem.model, first)
    floor, logs = measured(model, problem.quiet, problem.record, RUNS, seed)
    if len(logs) < RUNS // 2:
        return None
    noisy = replace(problem, model=model, floor=floor)
    if noisy.score <= noisy.limit + needed(noisy):
        return None
    legal = [
        one for one in candidates(noisy, noisy.quiet, catalogue) if one.effect and one.effect.name != first.effect.name
    ]
    fits = [fit for fit in ranked(legal, progress) if fit.present]
    if not fits or noisy.score - fits[0].total <= max(needed(noisy), UNLIKE * noisy.level):
        return None
    best = fits[0]
    if not (complete(noisy, best) or adequate(noisy, best)):
        return None
    return Beside(noisy, Pair(first, best), tuple(fits))
