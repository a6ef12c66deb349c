"""All explanations of a gap side by side: every effect at every place where it may be, each with its best sizes.

Candidates are compared by F plus a price for what they leave free: ``PRICE`` nats for each parameter that the record
feels beyond the first.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from diagram.diagram import Diagram
from diagram.progress import Progress, reporting
from gap.effect import Effect
from gap.hidden import fitted_hidden
from gap.loads import fitted_load, is_load
from gap.problem import Problem
from gap.search import Fit, fitted, refined

PRICE = 12.0
FOLLOWED = 6  # candidates that are fitted to the end
NEAR = 0.25  # share of the gap by which a candidate may lag behind the best after a few sizes, to be followed


def candidates(base: Diagram, catalogue: Iterable[Effect]) -> list[tuple[Effect, str]]:
    """Return every effect of a catalogue with every place in a diagram where it may be, without those of the log."""
    return [(effect, place) for effect in catalogue if not effect.of_log for place in effect.places(base)]


def ranked(
    problem: Problem, base: Diagram, legal: Sequence[tuple[Effect, str]], progress: Progress = None, e0: float = np.inf
) -> list[Fit]:
    """Return the best fit of every candidate that could be replayed, the best explanation first."""
    found: list[Fit] = []
    with reporting(progress, len(legal), "effects") as tell:
        for done, (effect, place) in enumerate(legal):
            way = _way(effect)
            fit = way(problem, base, effect, place)
            if fit is not None and np.isfinite(fit.F):
                found.append(replace(fit, price=price(problem, base, fit)))
            tell(done + 1, len(legal))
    found.sort(key=lambda fit: fit.total)
    if not found:
        return []
    margin = NEAR * max(min(e0, max(fit.F for fit in found)) - found[0].F, 0.0) + 100.0
    for k, fit in enumerate(found):
        if k >= FOLLOWED or fit.total > found[0].total + margin:
            break
        if not fit.effect.hidden:
            found[k] = replace(refined(problem, base, fit), price=fit.price)
    return sorted(found, key=lambda fit: fit.total)


def price(problem: Problem, base: Diagram, fit: Fit) -> float:
    """Return what the parameters of a fit cost [nats]."""
    return PRICE * (len(fit.effect.parameters) - 1)


def _way(effect: Effect) -> Callable[[Problem, Diagram, Effect, str], Fit | None]:
    if effect.hidden:
        return fitted_hidden
    return fitted_load if is_load(effect) else fitted
