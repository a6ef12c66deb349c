"""Controller modes as numbers: 0 manual (and all like it), 1 automatic, 2 cascade, NaN unknown."""

from __future__ import annotations

import re
import unicodedata

__all__ = ["AUTO", "CASCADE", "MANUAL", "mode_number", "says_manual"]

MANUAL, AUTO, CASCADE = 0.0, 1.0, 2.0

# Upper case without accents; a word also counts if it begins with one of the stems.
_AUTO = {"AUTO", "AUT", "A", "OTOMATIK", "TRUE", "自动", "自動"}
_AUTO_STEMS = ("AUTOM", "AUTOA", "АВТО")  # Automatik, automatique, automático, automaatti, ...
_CASCADE = {"CAS", "KAS", "RCAS", "BCAS", "C", "串级"}
_CASCADE_STEMS = ("CASC", "KASK", "КАСК")
_MANUAL = {"MAN", "M", "MANU", "HAND", "HND", "KASIN", "RUCNE", "FALSE", "手动", "手動"}
_MANUAL_STEMS = ("MANUA", "MANUE", "HANDB", "РУЧН")
# These stand beside another mode ("AUTO IMAN", "AUTO TUNE") and mean that the loop is not closed.
_OPEN = {"IMAN", "LO", "TRK", "TRACK", "TRACKING", "TUNE", "TUNING", "ROUT", "OOS", "OFF"}


def mode_number(text: str) -> float:
    """The number of the mode called ``text``; whatever is neither automatic nor cascade counts as manual.

    >>> [mode_number(text) for text in ("AUTO", "Cas", "P-RCAS", "MAN", "IMAN", "")]
    [1.0, 2.0, 2.0, 0.0, 0.0, nan]
    >>> [mode_number(text) for text in ("Automatik", "Automático", "Kaskade", "Hand", "16 AUTO", "AUT (IMAN)")]
    [1.0, 1.0, 2.0, 0.0, 1.0, 0.0]
    """
    if not text.strip():
        return float("nan")
    words = _words(text)
    if says_manual(text) or not _OPEN.isdisjoint(words):
        return MANUAL
    if any(word in _CASCADE or word.startswith(_CASCADE_STEMS) for word in words):
        return CASCADE
    if any(word in _AUTO or word.startswith(_AUTO_STEMS) for word in words):
        return AUTO
    return MANUAL


def says_manual(text: str) -> bool:
    """Whether ``text`` is a usual word for manual, so that nothing has to be assumed.

    >>> says_manual("Hand"), says_manual("Manuell"), says_manual("LO")
    (True, True, False)
    """
    return any(word in _MANUAL or word.startswith(_MANUAL_STEMS) for word in _words(text))


def _words(text: str) -> list[str]:
    """Words in upper case without accents, figures and punctuation."""
    apart = unicodedata.normalize("NFKD", text.upper())
    return re.findall(r"[^\W\d_]+", "".join(char for char in apart if not unicodedata.combining(char)))
