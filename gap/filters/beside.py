"""An effect that is not enough alone becomes part of the model, its sizes free: a second one is the same search again.

What bends (a law of the valve), what follows a plan and what sticks has no matrix, so it can be the second only.
"""

from collections.abc import Sequence
from dataclasses import replace

from stickslip.gap.filters.explaining import total
from stickslip.gap.filters.filtering import UNCHANGED
from stickslip.gap.filters.fitting import Found
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.rivals import TIE

FIRSTS = 3  # effects beside which a second one is looked for


def firsts(found: Sequence[Found]) -> list[Found]:
    """Return the effects, the likeliest first, beside which a second is looked for: of those in a tie only one."""
    kept: list[Found] = []
    for one in found:
        e = one.best.explanation
        has_matrix = e.effect is not None and not (e.law or e.load or e.sticks or e.effect.of_log)
        if has_matrix and all(total(one) > total(other) + TIE for other in kept):
            kept.append(one)
    return kept[:FIRSTS]


def with_effect(first: Found) -> Filtering:
    """Return the record through the model that has a fitted effect."""
    one = first.best.explanation
    assert one.effect is not None
    f, own = one.filtering, {name: first.best.values[name] for name in one.own}
    changed = one.effect.put(f.model, one.place)
    return replace(f, given=f.given.with_part(changed, one.effect, one.place, own, type(one.effect) not in UNCHANGED))
