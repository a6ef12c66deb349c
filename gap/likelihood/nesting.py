"""Effects that contain another: a stem that sticks and does not jump has a deadband and nothing else.

The narrower is meant where the wider gains nothing of relevance and the narrower leaves hardly anything: a play has one
law.  What it leaves is friction of another law than the model's, and friction is the wider of the two: of stems that
creep (LuGre's law) the best play leaves 6 to 10 % of the gap, of plays of another program at most 0.5 %.
"""

from collections.abc import Sequence

from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.left import judged_by_loss, left, level, share

TIE = 6.0  # nats between explanations that the record does not separate
RELEVANT = 0.01  # share of the gap that the wider must explain beyond the narrower
HARDLY = 0.02  # share of the gap that the narrower may leave


def one_of_nested(fits: Sequence[Fit], null: Fit) -> list[Fit]:
    """Return replayed fits with one of each two of which one contains the other and the record does not separate."""
    kept = list(fits)
    there = max(left(null.best) - level(null.best), 0.0)
    for wide in fits:
        for narrow in fits:
            if _contains(wide, narrow) and wide in kept and narrow in kept:
                gained = left(narrow.best) - left(wide.best)
                if abs(gained) <= TIE + RELEVANT * there:
                    alone = share(narrow, null) > 1.0 - HARDLY or not judged_by_loss(narrow, null).unusual
                    kept.remove(wide if alone else narrow)
                elif gained < 0.0:  # a wider one that fits worse has not been searched well enough
                    kept.remove(wide)
    return kept


def nested(one: Fit, other: Fit) -> bool:
    """Return whether one of two effects at one place contains the other."""
    return _contains(one, other) or _contains(other, one)


def _contains(wide: Fit, narrow: Fit) -> bool:
    a, b = wide.hypothesis, narrow.hypothesis
    return a.place == b.place and b.effect is not None and a.nests == b.effect.name
