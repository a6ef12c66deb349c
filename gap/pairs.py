"""Two effects at once: where one is not adequate, a second is added, then each is fitted again given the other."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from diagram.diagram import Diagram
from diagram.progress import Progress
from gap.adequacy import share
from gap.candidates import PRICE, candidates, ranked
from gap.effect import Effect
from gap.problem import Problem
from gap.search import Candidate, Fit, refined

FIRSTS = 2  # single effects to which a second is added
ENOUGH = 0.3  # share of the gap that one of two effects explains alone
TURNS = 2  # times that each is fitted again given the other


@dataclass(frozen=True, eq=False)
class Pair:
    """Two effects, each fitted in the presence of the other; the score is that of the second."""

    first: Fit
    second: Fit

    @property
    def total(self) -> float:
        """Score and price [nats]."""
        return self.second.F + self.first.price + self.second.price + PRICE


def paired(
    problem: Problem, fits: Sequence[Fit], catalogue: Iterable[Effect], progress: Progress = None
) -> Pair | None:
    """Return the best pair of effects; None if none could be replayed."""
    found: list[Pair] = []
    legal = list(catalogue)
    if not fits or share(problem, fits[0]) < ENOUGH:
        return None
    for first in [fit for fit in fits if not fit.candidate.noisy][:FIRSTS]:
        base = inserted(problem.quiet, first)
        seconds = [
            one
            for one in candidates(problem, base, legal)
            if not (one.effect is first.effect and one.place == first.place)
        ]
        ordered = ranked(seconds, progress, hidden=False)  # a hidden mode is found as the first or not at all
        if ordered:
            found.append(Pair(first, ordered[0]))
    if not found:
        return None
    return improved(problem, min(found, key=lambda pair: pair.total))


def improved(problem: Problem, pair: Pair) -> Pair:
    """Return a pair with each effect fitted again in the presence of the other."""
    for _ in range(TURNS):
        before = pair.total
        first = _again(problem, inserted(problem.quiet, pair.second), pair.first)
        second = _again(problem, inserted(problem.quiet, first), pair.second)
        new = Pair(first, second)
        if new.total >= before - 1.0:
            return new if new.total < before else pair
        pair = new
    return pair


def inserted(base: Diagram, fit: Fit) -> Diagram:
    """Return a diagram with the effect of a fit; noise is in no replay."""
    if fit.candidate.noisy:
        return base
    return fit.effect.insert(base, fit.place, **{name: fit.values[name] for name in fit.candidate.own})


def _again(problem: Problem, base: Diagram, fit: Fit) -> Fit:
    candidate = Candidate(problem, base, fit.effect, fit.place)
    start = candidate.tried([fit.values])
    return replace(refined(start[0], 3), price=fit.price) if start else fit
