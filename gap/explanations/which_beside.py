"""Which smooth effect occurs together with a stem: for each one the sizes of the stem are fitted again.

A stem's sizes make up for another effect, so beside the best stem alone the true one may gain nothing.

    F = min over S, J, d of  sum rho(e(S, J) + D d)        D slopes of the other effect, S and J over a grid

The best of these, and of a lag or a dead time a few sizes beside the stem as it is alone, are followed on the first
part of the record with wrong modes set right: what comes late hides its trough from replays that have the modes wrong.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.explanations.joint import in_turn, pursued
from stickslip.gap.fits.hidden import Lines, first_part_of, glimpsed_beside
from stickslip.gap.fits.inserting import begun
from stickslip.gap.fits.search import Candidate, Fit, best_of, slopes
from stickslip.gap.fits.together import marked, together
from stickslip.gap.floors.problem import Problem

TROUGHS = 2  # of each effect that are tried with modes set right
NODES, NEAR = 3, 6.0  # sizes of a lag that are tried, within a factor of the middle of its range
FOLLOWED = 3  # effects that are followed by patterns
WIDTHS = (0.15, 0.07)  # of these, relative to a size


def which_beside(problem: Problem, stem: Fit, others: Sequence[Candidate]) -> list[Fit]:
    """Return joint fits of other effects and a stem on the first part of the record, the best first.

    ``stem``: as it is alone; ``others``: smooth effects, at their places in the diagram without it.
    """
    starts = [fit for other in others if (fit := _start(problem, stem, other)) is not None]
    best = sorted(starts, key=lambda fit: fit.F)[:FOLLOWED]
    return sorted(pursued(best, lambda fit: in_turn(fit, WIDTHS)), key=lambda fit: fit.F)


def _start(problem: Problem, stem: Fit, other: Candidate) -> Fit | None:
    """Return the best of first sizes of another effect and a stem on the first part, with wrong modes set right."""
    head = first_part_of(problem, modes=True)
    own = replace(other, problem=head, base=problem.quiet)
    both = together(own, replace(stem.candidate, problem=head, base=problem.quiet))
    sizes = {name: stem.values[name] for name in stem.candidate.own}
    beside = [{**marked(values, "1."), **marked(sizes, "2.")} for values in _middle(own, NODES)]
    starts = _troughs(problem, replace(stem.candidate, base=problem.quiet), own) + beside
    return best_of(both.tried(starts)) if both and starts else None


def _troughs(problem: Problem, stem: Candidate, other: Candidate) -> list[dict[str, float]]:
    """Return sizes of both in the best troughs of a grid of the stem's sizes."""
    values = next(iter(_middle(other, 1)), other.nominal)
    there = best_of(other.tried([values])) if values is not other.nominal else other.absent
    J, names = slopes(there, other.sizes[:1]) if there else (np.zeros((0, 0)), [])
    if not names or other.effect is None:
        return []
    at = np.array([values[name] for name in names])
    low, high = np.array([other.bounds[name] for name in names]).T
    lines: Lines = J, np.minimum(low - at, 0.0), np.maximum(high - at, 0.0)
    base = problem.quiet  # a replay with another effect that has no size is one without it
    if values is not other.nominal:
        base = begun(problem, base, other.effect, other.place, {name: values[name] for name in other.own})
    return [
        {
            **marked({**values, **dict(zip(names, (at + one.moved).tolist(), strict=True))}, "1."),
            **marked(one.sizes, "2."),
        }
        for one in glimpsed_beside(replace(stem, base=base), lines)[:TROUGHS]
    ]


def _middle(other: Candidate, nodes: int) -> list[dict[str, float]]:
    """Return sizes in the middle of the range of a lag or a dead time, whose slope at none tells little; else none."""
    low, high = other.bounds[other.sizes[0]]
    if low <= other.nominal[other.sizes[0]] <= high or low <= 0.0:
        return []
    middle, wide = math.sqrt(low * high), NEAR ** (0.0 if nodes == 1 else 0.5)
    return [
        {**other.nominal, other.sizes[0]: float(size)} for size in np.geomspace(middle / wide, middle * wide, nodes)
    ]
