"""A fitted effect as part of a diagram."""

from diagram.diagram import Diagram
from gap.search import Fit


def inserted(base: Diagram, fit: Fit) -> Diagram:
    """Return a diagram with the effect of a fit; noise is in no replay."""
    if fit.candidate.noisy:
        return base
    return fit.effect.insert(base, fit.place, **{name: fit.values[name] for name in fit.candidate.own})
