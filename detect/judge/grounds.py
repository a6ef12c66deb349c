"""Why the model says what it says: the kinds of evidence that moved its log odds most, in words with their numbers.

    weight of a kind of evidence = sum of the shares of its features in the log odds (``model.Model.shares``)

Only what speaks for the verdict is said, the weightiest first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

__all__ = ["grounds"]

Found = Mapping[str, float]


def grounds(found: Found, shares: Mapping[str, float], sticks: bool) -> tuple[str, ...]:
    """The reasons for a verdict: the kinds of evidence that moved the log odds its way.

    ``found`` features by name [-]; ``shares`` of them in the log odds [-]; ``sticks`` what the verdict says.

    >>> told = {"travel_gain": 40.0, "network_sticky": 2.0}
    >>> grounds(told, {"travel_gain": 1.5, "network_sticky": -0.2}, True)
    ('A stem with dead travel predicts PV better than every rival, by 40 nats (log odds +1.5).',)
    """
    sign = 1.0 if sticks else -1.0
    weights = {
        kind: sign * math.fsum(share for name, share in shares.items() if name.startswith(starts))
        for kind, starts in KINDS.items()
    }
    first = sorted((kind for kind, weight in weights.items() if weight > 0.0), key=lambda kind: -weights[kind])
    return tuple(f"{kind(found, sticks)} (log odds {sign * weights[kind]:+.1f})." for kind in first)


def _learnt(found: Found, sticks: bool) -> str:
    like = "with a sticky valve" if sticks else "whose valve does not stick"
    return f"PV laid along OP has the pattern of simulated loops {like}, by the learnt convolutions"


def _travel(found: Found, sticks: bool) -> str:
    gain = found.get("travel_gain", math.nan)
    if not math.isfinite(gain):
        return "The record is one of those in which dead travel cannot be weighed"
    if gain > 0.0:
        return f"A stem with dead travel predicts PV better than every rival, by {gain:.0f} nats"
    return f"No stem with dead travel predicts PV better than the best rival; it lacks {-gain:.0f} nats"


def _process(found: Found, sticks: bool) -> str:
    known = found.get("process_integrates", math.nan)
    if not math.isfinite(known):
        return "Whether PV integrates is not known"
    return "PV integrates, as that of a level" if known else "PV settles by itself after a step of OP"


KINDS: Mapping[Callable[[Found, bool], str], str] = {_learnt: "network_", _travel: "travel_", _process: "process_"}
"""What says each kind of evidence, and with what the names of its features start."""
