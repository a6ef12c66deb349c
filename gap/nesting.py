"""Effects that contain another: a stem that sticks and does not jump has a deadband and nothing else.

The narrower is meant where the wider gains nothing of relevance and the narrower leaves nothing: a play has one law.
What it leaves is friction of another law than the model's, and friction is the wider of the two.
"""

from collections.abc import Sequence

from gap.adequacy import complete
from gap.problem import Problem
from gap.search import Fit

TIE = 6.0  # nats between explanations that the record does not tell apart
RELEVANT = 0.01  # share of the gap that the wider must explain beyond the narrower


def one_of_nested(problem: Problem, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits with one of each two of which one contains the other and that the record does not tell apart."""
    kept = list(fits)
    for wide in fits:
        for narrow in fits:
            if narrow.effect.name == wide.effect.nests and narrow.place == wide.place:
                gained = narrow.F - wide.F
                if abs(gained) <= TIE + RELEVANT * max(problem.score - problem.level, 0.0):
                    kept.remove(wide if complete(problem, narrow) else narrow)
                elif gained < 0.0:  # a wider one that fits worse has not been searched well enough
                    kept.remove(wide)
    return kept
