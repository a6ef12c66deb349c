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
from gap.search import Candidate, Fit, best_of, refined

SIZES = 5  # of the other effect
GAIN = 0.2  # of what the stem alone leaves at the first look, which the other effect has to take away


def with_stem(problem: Problem, stem: Fit, others: Sequence[Candidate]) -> Pair | None:
    """Return a stem and the other effect that suits it best at the first look; None if none takes enough away."""
    alone = first_look(replace(stem.candidate, base=problem.quiet))
    early = problem.early
    best, least = None, alone - GAIN * max(alone - early.floor.mean * early.rows, 0.0)
    for one in others:
        candidate = Candidate(problem, problem.quiet, one.effect, one.place)
        for values in _sizes(candidate):
            fit = replace(candidate.absent, candidate=candidate, values=values)
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


def over_range(candidate: Candidate) -> Fit | None:
    """Return the best size of an effect beside a stem on the whole record, refined; None if no run succeeded.

    Until a stem has moved for the first time its place is unknown, which hides much in the first part of a record.
    """
    best = best_of([candidate.absent, *candidate.tried(_sizes(candidate))])
    return None if best is None else replace(refined(best, 3), price=price(best))


def _sizes(candidate: Candidate) -> list[dict[str, float]]:
    """Return an effect's values at sizes over its range."""
    name = candidate.sizes[0]
    (spacing,) = (p.spacing for p in candidate.effect.parameters if p.name == name) if candidate.effect else ("log",)
    sizes = nodes_of(spacing, *candidate.bounds[name], candidate.nominal[name], SIZES)
    return [{**candidate.nominal, name: size} for size in sizes]
