"""Changes since the last scan of a plant, loop by loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Change", "changes"]


@dataclass(frozen=True)
class Change:
    """A loop whose verdict differs from that of the last scan.

    before, now : str
        Verdicts; "" where the loop was or is not there.
    """

    loop: str
    before: str
    now: str


def changes(before: pl.DataFrame | None, now: pl.DataFrame) -> tuple[Change, ...]:
    """Loops that are new, gone, or judged otherwise; none if there was no scan before.

    >>> import polars as pl
    >>> last, new = (pl.DataFrame({"loop": ["FIC1"], "verdict": [word]}) for word in ("inconclusive", "stiction"))
    >>> changes(last, new)
    (Change(loop='FIC1', before='inconclusive', now='stiction'),)
    """
    if before is None:
        return ()
    old = dict(zip(before["loop"], before["verdict"], strict=True))
    new = dict(zip(now["loop"], now["verdict"], strict=True))
    return tuple(
        Change(loop, old.get(loop) or "", new.get(loop) or "")
        for loop in dict.fromkeys([*new, *old])
        if (old.get(loop) or "") != (new.get(loop) or "")
    )
