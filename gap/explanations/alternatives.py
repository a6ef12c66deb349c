"""What else one of two effects could be, given the other: fits that the record does not separate from it."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.explanations.candidates import candidates, price
from stickslip.gap.explanations.isolability import SAME
from stickslip.gap.explanations.nesting import RELEVANT
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.explanations.proposals import smooth
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.ranges import fitted
from stickslip.gap.fits.search import Candidate, Fit, best_of, narrowed, near_neutral, refined, slopes
from stickslip.gap.fits.together import marked, together, values_of
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

Floats = NDArray[np.float64]
LIKE = 0.99  # cosine between the slopes of two effects at neutral, from which on the other is fitted too
LIKE_ALONE = 0.9  # the same without the other effect, where slopes are known already
TIE = 6.0  # nats between explanations that the record does not separate


def alternatives(problem: Problem, pair: Pair, catalogue: Iterable[Effect]) -> tuple[list[Fit], list[Fit]]:
    """Return for each of two effects what it could be as well, itself first."""
    legal = list(catalogue)
    return _instead(problem, pair.first, pair.second, legal), _instead(problem, pair.second, pair.first, legal)


def _instead(problem: Problem, fit: Fit, other: Fit, catalogue: Iterable[Effect]) -> list[Fit]:
    same = [fit]
    if fit.candidate.noisy:
        return same
    noisy = other.candidate.noisy  # more noise leaves a replay as it is, but makes it count for less
    base = problem.quiet if noisy else inserted(problem.quiet, other)
    here = replace(fit.candidate, base=base)
    best = refined(here.tried([fit.values])[0]) if noisy else fit
    beside = [] if noisy or other.effect.hidden else _columns(problem, other)
    own, alone = _without(near_neutral(here), beside), _alone(here)
    for candidate in candidates(problem, base, catalogue):
        known = candidate.effect is fit.effect or candidate.effect is other.effect
        if known or not smooth(candidate):
            continue
        if own is None or not _alike(alone, _alone(candidate), LIKE_ALONE):
            continue
        trace = _without(near_neutral(candidate), beside)
        if trace is None or not _alike(own, trace, LIKE):
            continue
        starts = [one for one in (fitted(candidate), *_as_large(candidate, fit, own, trace)) if one is not None]
        found = best_of([one for one in starts if one.present])
        if found is not None:
            found = refined(found)
            if found.F > best.F + TIE and beside:
                found = _both_again(problem, found, other)
            found = replace(found, price=price(found))
            near = TIE
            if other.effect.hidden and abs(_cosine(own, trace)) > SAME:  # one mode that starts otherwise tells nothing
                near += RELEVANT * max(problem.score - problem.level, 0.0)
            if _behind(found, best, other) <= near and found.price <= fit.price:
                same.append(found)
    return same


def _columns(problem: Problem, other: Fit) -> list[Floats]:
    """Return what a little more of each size of the other effect does: a lag elsewhere moves the phase of a load."""
    there = Candidate(problem, problem.quiet, other.effect, other.place).tried([other.values])
    return [np.nan_to_num(column) for fit in there[:1] for column in slopes(fit)[0].T]


def _without(trace: Floats | None, beside: Sequence[Floats]) -> Floats | None:
    """Return a slope without what the other effect makes up for; None for none."""
    if trace is None or not beside:
        return trace
    B, known = np.stack(beside, axis=1), np.nan_to_num(trace)
    B = B / np.maximum(np.linalg.norm(B, axis=0), 1e-300)
    left: Floats = known - B @ np.linalg.lstsq(B, known, rcond=1e-9)[0]
    return left


def _both_again(problem: Problem, found: Fit, other: Fit) -> Fit:
    """Return a fit in place of another with the sizes of both effects fitted at once; as it is where that fails.

    The score is what counts: the fit keeps its own sizes and takes the innovations that both leave.
    """
    both = together(replace(found.candidate, base=problem.quiet), replace(other.candidate, base=problem.quiet))
    start = both.tried([{**marked(found.values, "1."), **marked(other.values, "2.")}]) if both else []
    if not start:
        return found
    joint = refined(start[0])
    return replace(found, values=values_of(joint, "1."), F=joint.F, e=joint.e) if joint.F < found.F else found


def _behind(found: Fit, best: Fit, other: Fit) -> float:
    """Return the nats by which a fit is worse than the best one, beside another effect."""
    if not other.candidate.noisy:
        return found.F - best.F
    return narrowed(replace(other, e=found.e)).F - narrowed(replace(other, e=best.e)).F


def _as_large(candidate: Candidate, fit: Fit, own: Floats, trace: Floats) -> list[Fit]:
    """Return an effect at the sizes at which it does what another does, by their slopes or by the same number.

    Beside a stem the score is so jagged that a search of its own ends elsewhere.
    """
    name, other = candidate.sizes[0], fit.candidate.sizes[0]
    size, (low, high) = fit.values[other], candidate.bounds[name]
    moved = (size - fit.candidate.nominal[other]) * float(np.nansum(own * trace)) / float(np.nansum(trace**2))
    sizes = {candidate.nominal[name] + moved, size}
    return candidate.tried([{name: s} for s in sizes if low <= s <= high])


def _cosine(a: Floats, b: Floats) -> float:
    a, b = np.nan_to_num(a), np.nan_to_num(b)
    return float(a @ b) / float(np.linalg.norm(a) * np.linalg.norm(b))


def _alone(candidate: Candidate) -> Floats | None:
    """Return the slope of an effect's size at neutral without the other effect, which is known from proposing pairs."""
    quiet = candidate.problem.quiet
    if all(block.name != candidate.place for block in quiet.blocks):
        return None
    return near_neutral(replace(candidate, base=quiet))


def _alike(own: Floats | None, other: Floats | None, least: float) -> bool:
    """Return whether two slopes may be those of one effect; what has none alone may have some beside another."""
    return own is None or other is None or abs(_cosine(own, other)) >= least
