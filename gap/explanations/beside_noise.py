"""More noise of a sensor together with another effect, which is fitted to the signals under that noise.

    F(x, f) = sum rho(e(x)/f) + n ln f       x sizes of the other effect, f the noise in units of the model's

Noise is in no replay, so it can be tried beside every explanation there is at no cost.  With the best f the sizes of
the best are fitted again, and f again with these.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.adequacy import needed
from stickslip.gap.fits.noise import fitted_noise, is_noise
from stickslip.gap.fits.search import Candidate, Fit, refined
from stickslip.gap.floors.problem import Problem

TRIED = 3  # explanations that are fitted again


def beside_noise(problem: Problem, fits: Sequence[Fit]) -> list[Pair]:
    """Return pairs of one of several effects and more noise of a sensor, the best first; none if noise gains none."""
    loud = next((fit for fit in fits if fit.candidate.noisy and fit.present), None)
    if loud is None or problem.score - loud.F <= needed(problem):
        return []
    others = [fit for fit in fits if fit.present and not fit.candidate.noisy and not fit.effect.of_log]
    found = [pair for fit in others if (pair := with_noise(problem, fit, loud)) is not None]
    found.sort(key=lambda pair: pair.total)
    again = [_again(problem, pair) for pair in found[:TRIED]]
    return sorted((pair for pair in again if is_noise(pair.second)), key=lambda pair: pair.total)


def with_noise(problem: Problem, first: Fit, loud: Fit) -> Pair | None:
    """Return a fit with the noise of a sensor that suits what it leaves."""
    candidate = Candidate(problem, problem.quiet, loud.effect, loud.place)
    noise = fitted_noise(candidate, first)
    return None if noise is None else Pair(first, replace(noise, F=noise.F + first.charge, charge=first.charge))


def _again(problem: Problem, pair: Pair) -> Pair:
    """Return a pair with the sizes of its first effect fitted again in the noise of the second, and that again."""
    if pair.first.effect.hidden:
        return pair
    wider = _louder(problem, pair.second)
    start = replace(pair.first.candidate, problem=wider, base=wider.quiet).tried([pair.first.values])
    if not start:
        return pair
    values = refined(start[0]).values
    fit = pair.first.candidate.tried([values])[0]
    new = with_noise(problem, replace(fit, price=pair.first.price, followed=True), pair.second)
    return new if new is not None and new.total < pair.total else pair


def _louder(problem: Problem, noise: Fit) -> Problem:
    """Return the problem with the noise of a fit as the model's own."""
    pinned = problem.record.pinned
    louder = np.ones(len(pinned))
    for s in (str(s) for s in noise.candidate.base[noise.place].output_labels if str(s) in pinned):
        louder[pinned.index(s)] = noise.values["factor"]
    return replace(problem, floor=replace(problem.floor, L=problem.floor.L * louder))
