"""What an answer rests on: the kind of it, how large the gap was, how much of it is explained, what came next."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Evidence:
    """What an answer rests on: ``kind`` of the answer, ``gap`` [nats] to be explained, ``share`` of it that is,
    ``margin`` [nats] by which the best explanation outside the named set is worse.

    Kinds: "none" (no gap), "digits" (told by the digits of the log), "complete" (nothing is left), "adequate" (nearly
    nothing), "pair", "unknown"; of a filter "filter, digits", "filter, white" (what it leaves is usual), "filter,
    unknown"; of a large diagram, cut into segments, "segments, " and one of "complete", "adequate", "pair", "unknown".
    """

    kind: str
    gap: float
    share: float = 0.0
    margin: float = 0.0
