"""Records too short for any answer: a request of these alone ends as bad input does, whatever command it is made to."""

from collections.abc import Iterable

__all__ = ["refuse_short"]


def refuse_short(loops: Iterable[tuple[str, int, bool]]) -> None:
    """Raise ``ValueError`` where each loop has too few rows for the verdict and nothing answers on any.

    ``loops``: name, rows and whether the verdict or a method says something, of each. A command asks before it says or
    writes anything.
    """
    from stickslip.detect.judge.answer import SAMPLES_MIN

    given = list(loops)
    most = max((rows for _, rows, _ in given), default=SAMPLES_MIN)
    if most >= SAMPLES_MIN or any(answered for *_, answered in given):
        return
    names = ", ".join(name or "the loop" for name, *_ in given)
    counted = f"{most} row{'s' * (most > 1)}"
    raise ValueError(f"{names}: {counted}, of which no method can say anything; give {SAMPLES_MIN} rows or more")
