"""Records too short for any answer: a request of these alone ends as bad input does, whatever command it is made to."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stickslip.detect.verdict import Verdict


def too_short(loops: "Sequence[tuple[str, int, Sequence[Verdict]]]") -> str:
    """Return what is wrong where no method can look at any loop and each has too few rows for the verdict, else "".

    ``loops``: name, rows and the methods' verdicts of each.
    """
    from stickslip.detect.judge.answer import SAMPLES_MIN

    most = max((rows for _, rows, _ in loops), default=SAMPLES_MIN)
    if most >= SAMPLES_MIN or any(verdict.applicable for *_, verdicts in loops for verdict in verdicts):
        return ""
    names = ", ".join(name for name, *_ in loops)
    return f"{names}: {most} rows, of which no method can say anything; give {SAMPLES_MIN} rows or more"
