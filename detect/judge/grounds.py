"""Why the model says what it says: the kinds of evidence that moved its log odds most, in words with their numbers.

    weight of a kind of evidence = its share in the log odds (``model.Model.shares``), which is exact: they are a sum

Only what speaks for the verdict is said, the weightiest first, with the picture that shows it.
"""

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from stickslip.detect.judge.features import MOST_NATS

Found = Mapping[str, float]
LEAST = 0.05  # in log odds: what moves them less is no reason
Picture = Literal["", "learnt", "dead_travel", "stem_play", "slips", "still_stem"]


class Ground(NamedTuple):
    """A reason in words, and the picture that shows it ("" where none does)."""

    words: str
    picture: Picture


def grounds(found: Found, shares: Mapping[str, float], sticks: bool) -> tuple[Ground, ...]:
    """The reasons for a verdict: the kinds of evidence that moved the log odds its way.

    ``found`` features by name; ``shares`` of them in the log odds [-]; ``sticks`` what the verdict says.

    >>> features = {"dead_travel": 40.0, "network_sticky": 2.0}
    >>> (only,) = grounds(features, {"dead_travel": 1.5, "network_sticky": -0.2}, True)
    >>> only.words, only.picture
    ('A stem with dead travel predicts PV better than every rival, by 40 nats (log odds +1.5).', 'dead_travel')
    >>> grounds({"dead_travel": 100.0}, {"dead_travel": 1.5, "network_sticky": 0.0}, True)[0].words
    'A stem with dead travel predicts PV better than every rival, by more than 100 nats (log odds +1.5).'
    """
    sign = 1.0 if sticks else -1.0
    first = sorted((name for name in KINDS if sign * shares[name] >= LEAST), key=lambda name: -sign * shares[name])
    return tuple(
        Ground(f"{KINDS[name][0](found, sticks)} (log odds {shares[name]:+.1f}).", KINDS[name][1]) for name in first
    )


def _learnt(found: Found, sticks: bool) -> str:
    like = "with a sticky valve" if sticks else "whose valve does not stick"
    return f"PV laid along OP has the pattern of simulated loops {like}, by the learnt convolutions"


def _travel(found: Found, sticks: bool) -> str:
    gain = found["dead_travel"]
    more = "more than " if abs(gain) >= MOST_NATS else ""
    if gain > 0.0:
        return f"A stem with dead travel predicts PV better than every rival, by {more}{gain:.0f} nats"
    return f"No stem with dead travel predicts PV better than the best rival; it lacks {more}{-gain:.0f} nats"


KINDS: Mapping[str, tuple[Callable[[Found, bool], str], Picture]] = {
    "network_sticky": (_learnt, "learnt"), "dead_travel": (_travel, "dead_travel"),
}  # fmt: skip
"""What says each kind of evidence, by its feature, and what shows it."""
