"""A fitted effect as part of a diagram."""

from collections.abc import Mapping

from diagram.diagram import Diagram
from gap.effect import Effect
from gap.problem import Problem
from gap.search import Fit


def inserted(base: Diagram, fit: Fit) -> Diagram:
    """Return a diagram with the effect of a fit, started where its record starts; noise is in no replay."""
    if fit.candidate.noisy:
        return base
    own = {name: fit.values[name] for name in fit.candidate.own}
    return begun(fit.candidate.problem, base, fit.effect, fit.place, own)


def begun(problem: Problem, base: Diagram, effect: Effect, place: str, values: Mapping[str, float]) -> Diagram:
    """Return a diagram with an effect of these values, started where the record starts.

    A stem that starts elsewhere slips at other times, and its modes are wrong from row to row until it has caught up.
    """
    return effect.started(effect.insert(base, place, **values), place, problem.record.first)
