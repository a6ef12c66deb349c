"""Why the model says what it says: the kinds of evidence that moved its log odds, in words with their numbers.

    weight of a kind of evidence = its share in the log odds (``model.Model.shares``), which is exact: they are a sum

What speaks for the verdict comes first, the weightiest first, with the picture that shows it.  Behind the pattern comes
whether parts of the record have it too, and then what speaks against the verdict.
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
    """The reasons for a verdict, and what speaks against it.

    ``found`` features by name; ``shares`` of them in the log odds [-]; ``sticks`` what the verdict says.

    >>> features = {"dead_travel": 40.0, "network_sticky": -0.2, "network_first": 0.1, "network_last": -0.5}
    >>> for one in grounds(features, {"dead_travel": 1.5, "network_sticky": -0.2}, True):
    ...     print(one.words)
    A stem with dead travel predicts PV better than every rival, by 40 nats (log odds +1.5).
    Against it: PV laid along OP has the pattern of simulated loops whose valve does not stick (log odds -0.2).
    >>> features = {"dead_travel": 40.0, "network_sticky": 2.0, "network_first": 2.5, "network_last": -0.1}
    >>> grounds(features, {"dead_travel": 0.0, "network_sticky": 2.0}, True)[1].words
    'The first 80 % of the record has it too (log odds +2.5); the last has not (-0.1).'
    >>> grounds({"dead_travel": 100.0}, {"dead_travel": 1.5, "network_sticky": 0.0}, True)[0].words
    'A stem with dead travel predicts PV better than every rival, by more than 100 nats (log odds +1.5).'
    """
    sign = 1.0 if sticks else -1.0
    first = sorted((name for name in KINDS if abs(shares[name]) >= LEAST), key=lambda name: -sign * shares[name])
    said = {name: f"{KINDS[name][0](found)} (log odds {shares[name]:+.1f})." for name in first}
    ahead = list[Ground]()
    for name in first:
        if sign * shares[name] > 0.0:
            parts = _parts(found, shares[name], sign) if name == "network_sticky" else []
            ahead += [Ground(said[name], KINDS[name][1]), *parts]
    against = [Ground(f"Against it: {_small(said[name])}", "") for name in first if sign * shares[name] < 0.0]
    return (*ahead, *against)


def _parts(found: Found, share: float, sign: float) -> list[Ground]:
    """Whether each end of the record says the same alone; nothing where the pattern does not count."""
    whole = found.get("network_sticky", 0.0)
    each = [share * found[name] / whole for name in ("network_first", "network_last") if whole and name in found]
    if len(each) < 2 or sign * share < LEAST:
        return []
    first, last = each
    has = [sign * odds >= LEAST for odds in each]
    if has[0] == has[1]:
        words = f"The first and the last 80 % of the record have it {'too' if has[0] else 'less clearly'}"
        return [Ground(f"{words} (log odds {first:+.1f} and {last:+.1f}).", "")]
    one, other = ("first", "last") if has[0] else ("last", "first")
    own, less = (first, last) if has[0] else (last, first)
    return [
        Ground(f"The {one} 80 % of the record has it too (log odds {own:+.1f}); the {other} has not ({less:+.1f}).", "")
    ]


def _small(words: str) -> str:
    return words if words.startswith("PV ") else words[0].lower() + words[1:]


def _learnt(found: Found) -> str:
    like = "with a sticky valve" if found["network_sticky"] > 0.0 else "whose valve does not stick"
    return f"PV laid along OP has the pattern of simulated loops {like}"


def _travel(found: Found) -> str:
    gain = found["dead_travel"]
    more = "more than " if abs(gain) >= MOST_NATS else ""
    if gain > 0.0:
        return f"A stem with dead travel predicts PV better than every rival, by {more}{gain:.0f} nats"
    return f"No stem with dead travel predicts PV better than the best rival; it lacks {more}{-gain:.0f} nats"


KINDS: Mapping[str, tuple[Callable[[Found], str], Picture]] = {
    "network_sticky": (_learnt, "learnt"), "dead_travel": (_travel, "dead_travel"),
}  # fmt: skip
"""What says each kind of evidence, by its feature, and what shows it."""
