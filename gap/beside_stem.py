"""A stem that sticks beside another effect, the sizes of both looked for at once.

Beside a lag a stem fitted alone gets wrong sizes, beside which no size of the lag helps.  So the few effects that
promise most are put in at sizes over their range, and at each the stem is looked for as if it were alone.
"""

from collections.abc import Sequence
from dataclasses import replace

from gap.candidates import price
from gap.hidden import first_look, glimpsed
from gap.inserting import inserted
from gap.pair import Pair
from gap.problem import Problem
from gap.ranges import nodes_of
from gap.search import Candidate, Fit, best_of

SIZES = 5  # of the other effect
GAIN = 0.2  # of what the stem alone leaves at the first look, which the other effect has to take away


def with_stem(problem: Problem, stem: Fit, others: Sequence[Candidate]) -> Pair | None:
    """Return a stem and the other effect that suits it best at the first look; None if none takes enough away."""
    alone = first_look(replace(stem.candidate, base=problem.quiet))
    early = problem.early
    best, least = None, alone - GAIN * max(alone - early.floor.mean * early.rows, 0.0)
    for one in others:
        candidate = Candidate(problem, problem.quiet, one.effect, one.place)
        for fit in _over_range(candidate):
            found = first_look(replace(stem.candidate, base=inserted(problem.quiet, fit)))
            if found < least:
                best, least = fit, found
    if best is None:
        return None
    sticks = glimpsed(replace(stem.candidate, base=inserted(problem.quiet, best)))
    if sticks is None:
        return None
    sticks = replace(sticks, price=price(sticks))
    beside = best_of(replace(best.candidate, base=inserted(problem.quiet, sticks)).tried([best.values]))
    return None if beside is None else Pair(replace(beside, price=price(beside)), sticks)


def _over_range(candidate: Candidate) -> list[Fit]:
    """Return an effect at sizes over its range, not replayed."""
    name = candidate.sizes[0]
    (spacing,) = (p.spacing for p in candidate.effect.parameters if p.name == name) if candidate.effect else ("log",)
    sizes = nodes_of(spacing, *candidate.bounds[name], candidate.nominal[name], SIZES)
    return [replace(candidate.absent, candidate=candidate, values={**candidate.nominal, name: s}) for s in sizes]
