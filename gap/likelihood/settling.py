"""Fits in all rows of a record: values and the instants at which inputs switch, in turn."""

from dataclasses import replace

from stickslip.gap.likelihood.fit import ROUNDS, Fit, refined, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.switches import moved_alike, with_switches

FIRST = 2  # rounds of a first fit
SETTLING = 4  # times that a fit and the switches of its inputs follow each other


def settled(fit: Fit, rounds: int = SETTLING) -> Fit:
    """Return a fit in all rows, its inputs switching when that suits it."""
    one = fit.hypothesis
    start = tried(one.of(replace(one.frame, apart=False)), fit.best.values)
    if start is None:
        return fit
    for left in reversed(range(rounds)):
        moved = with_switches(start)
        fit = refined(moved, free_names(one), ROUNDS if one.frame.replays else FIRST)
        # switches of the model alone make up for what it lacks: they follow its sizes, and no other switches
        if fit.best is not (moved if one.effect is None else start):
            start = fit.best
            continue
        ahead = moved_alike(fit) if left else None
        if ahead is None:
            break
        start = ahead
    return fit


def free_names(one: Hypothesis) -> tuple[str, ...]:
    """Return the parameters that a fit varies: those of the effect that have a slope, and all that is free."""
    own = tuple(p.name for p in one.effect.parameters if p.smooth) if one.effect else ()
    return (*own, *one.frame.free)
