"""All explanations of a gap side by side: every effect at every place where it may be, each with its best sizes.

Candidates are compared by F plus a price for what they leave free: ``PRICE`` nats for each parameter that the record
feels beyond the first.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress, reporting
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.fits.adequacy import needed, scored_alone, stands
from stickslip.gap.fits.hidden import fitted_hidden, promising
from stickslip.gap.fits.limits import fitted_limits
from stickslip.gap.fits.loads import fitted_load, is_load
from stickslip.gap.fits.noise import fitted_noise, is_noise
from stickslip.gap.fits.ranges import fitted
from stickslip.gap.fits.scans import fitted_scan
from stickslip.gap.fits.search import Candidate, Fit, exact, refined
from stickslip.gap.fits.sensitivity import promised
from stickslip.gap.fits.texture import fitted_lattice
from stickslip.gap.floors.problem import Problem
from stickslip.gap.insertion.effect import Effect

PRICE = 12.0
FOLLOWED, FOLLOWED_FREE = 6, 14  # candidates that are fitted to the end; where parameters have tolerances
HOPE = 0.3  # share of the nats that an effect needs to be named, which its slope must promise
NEAR = 0.25  # share of what the best takes away, by which a candidate may lag behind it after a few sizes


def candidates(problem: Problem, base: Diagram, catalogue: Iterable[Effect]) -> list[Candidate]:
    """Return every effect of a catalogue with every place in a diagram where it may be, without those of the log."""
    return [
        Candidate(problem, base, effect, place)
        for effect in catalogue
        if not effect.of_log
        for place in effect.places(problem.model if isinstance(effect, SensorNoise) else base)
        if not problem.record.suspects or place in problem.record.suspects
    ]


def ranked(legal: Sequence[Candidate], progress: Progress = None) -> list[Fit]:
    """Return the best fit of every candidate that could be replayed, the best explanation first.

    Effects with a hidden mode, which cost most, come last, the simpler first, and only while nothing else explains the
    record.
    """
    if not legal:
        return []
    found: list[Fit] = []
    kept: list[Candidate] | None = None
    problem = legal[0].problem
    quick = [replace(one, problem=problem.quick) for one in legal]
    ordered = sorted(quick, key=lambda one: len(one.own) if one.effect and one.effect.hidden else 0)
    with reporting(progress, len(legal), "effects") as tell:
        for done, candidate in enumerate(ordered):
            last = bool(candidate.effect and candidate.effect.hidden)
            if last and not followed(found):
                found = _finished(problem, found)
            told = bool(found) and (_at_floor(found[0]) or any(_by_digits(fit) for fit in found))
            if last and not told and kept is None:
                hidden = [one for one in ordered if one.effect and one.effect.hidden]
                kept = hidden if candidate.problem.record.filter is None else promising(hidden)
            if (not last or (not told and candidate in (kept or ()))) and _hopeful(candidate):
                fit = way(candidate)(candidate)
                if fit is not None and np.isfinite(fit.F):
                    found.append(replace(fit, price=price(fit)))
            tell(done + 1, len(legal))
    return _finished(problem, found)


def _at_floor(fit: Fit) -> bool:
    """Return whether a fit leaves what records without a gap have."""
    return fit.candidate.problem.limit >= scored_alone(fit) and (not fit.candidate.noisy or is_noise(fit))


def _by_digits(fit: Fit) -> bool:
    """Return whether the digits of the log tell an effect, beside which none with a hidden mode is looked for."""
    return isinstance(fit.effect, Quantisation) and fit.candidate.problem.score > fit.F


def _hopeful(candidate: Candidate) -> bool:
    """Return whether an effect may gain something worth a word, where all that is missing is little.

    A gap that does not show in the score by itself is of small effects only, and slopes tell what these can gain.
    """
    problem = candidate.problem
    if problem.score > problem.limit or way(candidate) is not fitted:
        return True
    return promised(candidate) > HOPE * needed(problem)


def followed(found: Sequence[Fit]) -> bool:
    """Return whether the best of the fits have been refined already."""
    return any(fit.followed for fit in found)


def _finished(problem: Problem, found: Sequence[Fit]) -> list[Fit]:
    """Return the fits in order, the best of them fitted to the end."""
    if not found:
        return []
    most = FOLLOWED_FREE if problem.free else FOLLOWED
    ordered = sorted(_own(problem, found, most), key=lambda fit: fit.total)
    done = []
    for k, fit in enumerate(ordered):
        near = k < most and fit.present and fit.total <= ordered[0].total + _margin(ordered)
        told = stands(problem, fit)  # what the digits give is not to be moved
        if near and not fit.followed and not told and (not fit.effect.hidden or problem.free):
            fit = replace(refined(fit), followed=True)
        done.append(fit)
    return sorted(done, key=lambda fit: fit.total)


def _own(problem: Problem, found: Sequence[Fit], most: int) -> list[Fit]:
    """Return fits of which those that may be followed are replayed with runs of their own."""
    ordered = sorted(found, key=lambda fit: fit.total)
    last = ordered[0].total + _margin(ordered)
    return [
        (k < 2 * most and fit.total <= last and exact(fit, problem)) or fit for k, fit in enumerate(ordered)
    ]  # fmt: skip


def _margin(ordered: Sequence[Fit]) -> float:
    """Return the nats by which a fit may lag behind the best of all, the first, to be followed."""
    return NEAR * max(ordered[0].candidate.absent.F - ordered[0].F, 0.0) + 100.0


def price(fit: Fit) -> float:
    """Return the penalty for the parameters of a fit, in log likelihood; unchanged parameters cost nothing."""
    moved = [name for name in fit.candidate.own if fit.values[name] != fit.candidate.nominal[name]]
    return PRICE * max(len(moved) - 1, 0)


def way(candidate: Candidate) -> Callable[[Candidate], Fit | None]:
    """Return how a candidate is fitted first."""
    effect = candidate.effect
    if effect is not None and effect.hidden:
        return fitted_hidden
    if isinstance(effect, SensorNoise):
        return fitted_noise
    if isinstance(effect, Quantisation):
        return fitted_lattice
    if isinstance(effect, ScanTime):
        return fitted_scan
    if candidate.own == ("low", "high"):
        return fitted_limits
    return fitted_load if effect is not None and is_load(effect) else fitted
