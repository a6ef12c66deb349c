"""What an answer rests on: the kind of it, and how large the gap was."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Evidence:
    """What an answer rests on: ``kind`` of the answer, ``gap`` [nats] by which the log is likelier with it.

    Kinds: "none" (no gap), "digits" (told by the digits of the log), "white" (what it leaves is usual), "pair" (so is
    what two effects leave), "unknown".
    """

    kind: str
    gap: float
