"""Published figures: the rows of thesis tables 2.1 and 2.2, and published shares of loops judged rightly.

Every figure says where it stands.  "printed": read there.  "second hand": quoted by a text that we read, not seen
ourselves.  A share is set beside ours with its 90 % interval by Wilson; the sets of loops differ, so that only a wide
gap means anything.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Mark = Literal["printed", "second hand"]
_KEPT = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class ThesisRow:
    """One method of the thesis: its number, principle and reference of table 2.1, its load of table 2.2.

    ``methods`` are our modules for it; ``top_five`` whether Horch 2007 has it among his five best, by thesis 6.2.
    """

    number: str
    principle: str
    reference: str
    load: str
    methods: tuple[str, ...]
    top_five: bool = False


THESIS = tuple(ThesisRow(**row | {"methods": tuple(row["methods"])}) for row in _KEPT["thesis"])
"""Table 2.1 and the column Load of table 2.2.  The thesis credits xii to Yamashita; its text (2.4) and ours to Kano."""


@dataclass(frozen=True)
class Share:
    """A published share: ``right`` of ``of`` loops (None where only the share is known), of what, by which method.

    ``method`` is our module where we have the method, "" where we have not.
    """

    what: str
    share: float
    right: int | None
    of: int | None
    loops: str
    source: str
    mark: Mark
    method: str = ""


PUBLISHED = tuple(Share(**share) for share in _KEPT["shares"])
"""Published shares that can be set beside ours; see each for its source."""


def wilson(right: int, of: int, z: float = 1.645) -> tuple[float, float]:
    """Interval of a share, 90 % by default (z = 1.645): Wilson, J. Am. Stat. Assoc. 22 (1927) 209.

    Raises ValueError unless 0 <= right <= of and of >= 1.

    >>> [round(end, 2) for end in wilson(18, 20, z=1.96)]
    [0.7, 0.97]
    """
    if not (of >= 1 and 0 <= right <= of):
        raise ValueError(f"{right} of {of}; give 0 <= right <= of and at least one loop")
    share, n = right / of, float(of)
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(share * (1 - share) / n + z * z / (4 * n * n))
    return max(middle - half, 0.0), min(middle + half, 1.0)


def interval_words(right: int, of: int) -> str:
    """The interval of ``wilson`` in words.

    >>> interval_words(6, 13)
    '26% to 68%'
    """
    low, high = wilson(right, of)
    return f"{low:.0%} to {high:.0%}"
