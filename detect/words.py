"""The four words of a verdict, and all that is said, written or drawn of each of them; no other file spells them out.

A new place where verdicts appear takes what it needs from ``WORDS[verdict.verdict]``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from stickslip.logs.style import AFTER, GREEN, INK, RED, UNUSED

Word = Literal["stiction", "no_stiction", "inconclusive", "not_applicable"]
Kind = Literal["bad", "good", "open"]


@dataclass(frozen=True)
class Wording:
    """How one word of a verdict is said, numbered and shown.

    Parameters: ``spoken`` (str) The word as people read it; ``of_several`` (str) The same after a count of methods, as
    in "3 say stiction"; ``sentence`` (str) The first sentence of an answer with this verdict; ``number`` (float) The
    value of a signal that carries verdicts [-]; ``letter`` (str) For a table without room for words; ``kind`` Of the
    section on a page and of the colour in a terminal; ``colour``, ``ink`` (str) Ground and letter in a picture.

    >>> WORDS["no_stiction"].spoken, WORDS["no_stiction"].number, WORDS["stiction"].kind
    ('no stiction', 2.0, 'bad')
    """

    spoken: str
    of_several: str
    sentence: str
    number: float
    letter: str
    kind: Kind
    colour: str
    ink: str

    def counted(self, n: int) -> str:
        """Return what ``n`` methods say.

        >>> WORDS["stiction"].counted(1), WORDS["stiction"].counted(3), WORDS["not_applicable"].counted(1)
        ('1 says stiction', '3 say stiction', '1 does not apply')
        """
        first, _, rest = self.of_several.partition(" ")
        return f"{n} {ALONE.get(first, first) if n == 1 else first} {rest}"


ALONE = {"say": "says", "do": "does"}  # of one

# Each word has a letter besides its colour, for print and for eyes that do not tell the colours apart.
WORDS: Mapping[Word, Wording] = MappingProxyType({
    "stiction": Wording(
        "stiction", "say stiction", "The valve looks sticky.", 3.0, "S", "bad", RED, "white",
    ),
    "no_stiction": Wording(
        "no stiction", "say no stiction", "No sign of stiction in this oscillation.", 2.0, "N", "good", GREEN, "white",
    ),
    "inconclusive": Wording(
        "inconclusive", "cannot tell", "The record does not settle whether the valve sticks.", 1.0, "?", "open", AFTER,
        INK,
    ),
    "not_applicable": Wording(
        "not applicable", "do not apply", "No method can judge this record.", 0.0, "-", "open", UNUSED, INK,
    ),
})  # fmt: skip
"""The wording of each word, in the order in which counts of verdicts are listed."""
