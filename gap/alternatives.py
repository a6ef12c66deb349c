"""What else one of two effects could be, given the other: fits that the record does not tell apart from it."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gap.candidates import candidates, price
from gap.effect import Effect
from gap.inserting import inserted
from gap.pairs import Pair
from gap.problem import Problem
from gap.proposals import smooth
from gap.ranges import fitted
from gap.search import Candidate, Fit, refined, slopes

Floats = NDArray[np.float64]
LIKE = 0.99  # cosine between the slopes of two effects at neutral, from which on the other is fitted too
TIE = 6.0  # nats between explanations that the record does not tell apart


def alternatives(problem: Problem, pair: Pair, catalogue: Iterable[Effect]) -> tuple[list[Fit], list[Fit]]:
    """Return for each of two effects what it could be as well, itself first."""
    legal = list(catalogue)
    return _instead(problem, pair.first, pair.second, legal), _instead(problem, pair.second, pair.first, legal)


def _instead(problem: Problem, fit: Fit, other: Fit, catalogue: Iterable[Effect]) -> list[Fit]:
    same = [fit]
    base = inserted(problem.quiet, other)
    own = _trace(replace(fit.candidate, base=base))
    for candidate in candidates(problem, base, catalogue):
        known = candidate.effect is fit.effect or candidate.effect is other.effect
        if known or not smooth(candidate) or "time" in candidate.own or fit.candidate.noisy or other.candidate.noisy:
            continue
        if own is None or (trace := _trace(candidate)) is None or abs(float(own @ trace)) < LIKE:
            continue
        found = fitted(candidate)
        if found is not None and found.present:
            found = refined(found)
            found = replace(found, price=price(found))
            if found.F <= fit.F + TIE and found.price <= fit.price:
                same.append(found)
    return same


def _trace(candidate: Candidate) -> Floats | None:
    """Return the slope of the innovations in an effect's size at neutral, of length 1; None if there is none."""
    J, felt = slopes(candidate.absent, candidate.sizes[:1])
    if not felt:
        return None
    column = np.nan_to_num(J[:, 0])
    return column / float(np.linalg.norm(column))
