"""Controller modes as numbers: 0 manual (and all like it), 1 automatic, 2 cascade, NaN unknown."""

from __future__ import annotations

__all__ = ["AUTO", "CASCADE", "MANUAL", "mode_number"]

MANUAL, AUTO, CASCADE = 0.0, 1.0, 2.0

_AUTO = {"AUTO", "AUT", "A", "AUTOMATIC"}
_CASCADE = {"CAS", "RCAS", "CASC", "CASCADE", "C", "BCAS"}


def mode_number(text: str) -> float:
    """The number of the mode called `text`; whatever is neither automatic nor cascade counts as manual.

    >>> [mode_number(text) for text in ("AUTO", "Cas", "P-RCAS", "MAN", "IMAN", "")]
    [1.0, 2.0, 2.0, 0.0, 0.0, nan]
    """
    word = text.strip().upper()
    if not word:
        return float("nan")
    word = word.removeprefix("P-")  # the program-controlled twin of a mode
    if word in _AUTO:
        return AUTO
    return CASCADE if word in _CASCADE else MANUAL
