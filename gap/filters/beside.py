"""An effect that is not enough alone becomes part of the model, its sizes free: a second one is the same search again.

What bends (a law of the valve) and what sticks has no matrix, so it can be the second only.
"""

from collections.abc import Sequence
from dataclasses import replace

from stickslip.gap.filters.explaining import free_names, total
from stickslip.gap.filters.filtering import UNCHANGED, Explanation
from stickslip.gap.filters.fitting import Found, refined, tried
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.rivals import TIE
from stickslip.gap.records.given import Given, Part

FIRSTS = 3  # effects beside which a second one is looked for
NEAR = 0.2  # share of what the first gains, by which another may lag behind it to be asked in its place


def has_matrix(one: Explanation) -> bool:
    """Return whether an effect can be part of a model that a filter has."""
    return one.effect is not None and not (one.law or one.sticks or one.effect.of_log)


def firsts(found: Sequence[Found]) -> list[Found]:
    """Return the effects, the likeliest first, beside which a second is looked for: of those in a tie only one."""
    kept: list[Found] = []
    for one in found:
        if has_matrix(one.best.explanation) and all(total(one) > total(other) + TIE for other in kept):
            kept.append(one)
    return kept[:FIRSTS]


def with_effect(first: Found) -> Filtering:
    """Return the record through the model that has a fitted effect."""
    one = first.best.explanation
    assert one.effect is not None
    f, own = one.filtering, {name: first.best.values[name] for name in one.own}
    if one.load:  # it is played, no block of the diagram
        return replace(f, given=Given(f.model, Part(one.effect, one.place, own, one.bounds), f.given))
    changed = one.effect.put(f.model, one.place)
    return replace(f, given=f.given.with_part(changed, one.effect, one.place, own, type(one.effect) not in UNCHANGED))


def in_its_place(first: Found, second: Found, found: Sequence[Found], plain: float) -> list[Found]:
    """Return the first effect, and those that leave as much in its place beside the second; ``plain``: nll of none."""
    same = [first]
    for one in found:
        if one is first or not has_matrix(one.best.explanation) or one.nll > first.nll + NEAR * (plain - first.nll):
            continue
        f, other = with_effect(one), second.best.explanation
        beside = other.effect is not None and other.place in f.given.places(other.effect)
        start = tried(replace(other, filtering=f), second.best.values) if beside else None
        if start is not None:
            fit = refined(start, free_names(start.explanation))
            same += [one] if fit.nll <= second.nll + TIE else []
    return same
