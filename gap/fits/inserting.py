"""A fitted effect as part of a diagram."""

from collections.abc import Mapping

from stickslip.diagram.diagram import Diagram
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect


def inserted(base: Diagram, fit: Fit) -> Diagram:
    """Return a diagram with the effect of a fit; noise is in no replay."""
    if fit.candidate.noisy:
        return base
    own = {name: fit.values[name] for name in fit.candidate.own}
    return begun(fit.candidate.problem, base, fit.effect, fit.place, own)


def begun(problem: Problem, base: Diagram, effect: Effect, place: str, values: Mapping[str, float]) -> Diagram:
    """Return a diagram with an effect of these values; a stem starts where the record puts it.

    What is no stem starts as it is: the pins of the first rows set it right, and a lag that starts at one noisy value
    has been seen to cost 400 modes of a stem beside it.
    """
    changed = effect.insert(base, place, **values)
    return effect.started(changed, place, problem.record.first) if effect.hidden else changed
