"""Why the model says what it says: the kinds of evidence that moved its log odds most, in words with their numbers.

    weight of a kind of evidence = sum of the shares of its features in the log odds (``model.Model.shares``)

Only what speaks for the verdict is said, the weightiest first, with the picture that shows it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from stickslip.detect.judge.features.dead_travel import MOST

__all__ = ["Ground", "Picture", "grounds"]

Found = Mapping[str, float]
LEAST = 0.05  # in log odds: what moves them less is no reason
Picture = Literal["", "learnt", "dead_travel", "stem_play", "slips", "still_stem"]


class Ground(NamedTuple):
    """A reason in words, and the picture that shows it ("" where none does)."""

    words: str
    picture: Picture


def grounds(found: Found, shares: Mapping[str, float], sticks: bool) -> tuple[Ground, ...]:
    """The reasons for a verdict: the kinds of evidence that moved the log odds its way.

    ``found`` features by name [-]; ``shares`` of them in the log odds [-]; ``sticks`` what the verdict says.

    >>> features = {"travel_gain": 40.0, "network_sticky": 2.0}
    >>> (only,) = grounds(features, {"travel_gain": 1.5, "network_sticky": -0.2}, True)
    >>> only.words, only.picture
    ('A stem with dead travel predicts PV better than every rival, by 40 nats (log odds +1.5).', 'dead_travel')
    """
    sign = 1.0 if sticks else -1.0
    weights = {
        kind: sign * math.fsum(share for name, share in shares.items() if name.startswith(starts))
        for kind, (starts, _) in KINDS.items()
    }
    first = sorted((kind for kind, weight in weights.items() if weight >= LEAST), key=lambda kind: -weights[kind])
    return tuple(
        Ground(f"{kind(found, sticks)} (log odds {sign * weights[kind]:+.1f}).", KINDS[kind][1]) for kind in first
    )


def _learnt(found: Found, sticks: bool) -> str:
    like = "with a sticky valve" if sticks else "whose valve does not stick"
    return f"PV laid along OP has the pattern of simulated loops {like}, by the learnt convolutions"


def _travel(found: Found, sticks: bool) -> str:
    gain = found.get("travel_gain", math.nan)
    if not math.isfinite(gain):
        return "The record is one of those in which dead travel cannot be weighed"
    more = "more than " if abs(gain) >= MOST else ""
    if gain > 0.0:
        return f"A stem with dead travel predicts PV better than every rival, by {more}{gain:.0f} nats"
    return f"No stem with dead travel predicts PV better than the best rival; it lacks {more}{-gain:.0f} nats"


def _process(found: Found, sticks: bool) -> str:
    known = found.get("process_integrates", math.nan)
    if not math.isfinite(known):
        return "Whether PV integrates is not known"
    return "PV integrates, as that of a level" if known else "PV settles by itself after a step of OP"


KINDS: Mapping[Callable[[Found, bool], str], tuple[str, Picture]] = {
    _learnt: ("network_", "learnt"), _travel: ("travel_", "dead_travel"), _process: ("process_", ""),
}  # fmt: skip
"""What says each kind of evidence, with what the names of its features start, and what shows it."""
