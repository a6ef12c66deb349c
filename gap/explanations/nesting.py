"""Effects that contain another: a stem that sticks and does not jump has a deadband and nothing else.

The narrower is meant where the wider gains nothing of relevance and the narrower leaves hardly anything: a play has one
law.  What it leaves is friction of another law than the model's, and friction is the wider of the two: of stems that
creep (LuGre's law) the best play leaves 6 to 10 % of the gap, of plays of another program at most 0.5 %.
"""

from collections.abc import Sequence

from stickslip.gap.fits.adequacy import complete, share
from stickslip.gap.fits.search import Fit
from stickslip.gap.floors.problem import Problem

TIE = 6.0  # nats between explanations that the record does not separate
RELEVANT = 0.01  # share of the gap that the wider must explain beyond the narrower
# share that the narrower may leave: of the gap, and beside another effect of what that one leaves
HARDLY, HARDLY_BESIDE = 0.02, 0.05


def one_of_nested(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits with one of each two of which one contains the other and that the record does not separate."""
    kept = list(fits)
    for wide in fits:
        for narrow in fits:
            if narrow.effect.name == wide.effect.nests and narrow.place == wide.place:
                gained = narrow.F - wide.F
                if abs(gained) <= TIE + RELEVANT * max(problem.score - problem.level, 0.0):
                    alone = complete(problem, narrow) or share(problem, narrow) > 1.0 - HARDLY
                    kept.remove(wide if alone else narrow)
                elif gained < 0.0:  # a wider one that fits worse has not been searched well enough
                    kept.remove(wide)
    return kept
