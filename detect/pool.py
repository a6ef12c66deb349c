"""How a method whose index is made of half waves, blocks or runs follows a stream: it keeps what it found of each.

The method gives two functions.  ``seen(p, loop)`` looks at a window and returns its pieces as a ``Pool``, or the
refusal of that window; ``judged(p, loop, pool)`` makes the verdict of pieces, in batch those of the whole record.
``pooled`` makes of them the functions that ``LoopStream`` and ``window_twin`` call:

    remember    adds the pieces of a window that is about to lose its older half; a refused window ends the story
    recall      the verdict on the pieces kept and those of the window now

Period, noise and drift are those of the window, where the batch form takes them from the whole record; that is the only
difference between the two, and the card's ``stream_bound`` says how much it may make.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.verdict import Verdict
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

MOST = 400  # pieces kept


class Pool(NamedTuple):
    """Pieces in order of time: middle ``at`` (m,) [s], numbers of each (m, k), and the start of the search.

    ``apart`` [s] is how far the middle of a new piece must lie behind the last one; 0 where pieces do not overlap.
    """

    at: Values
    rows: Values
    since: float
    apart: float = 0.0


Past: TypeAlias = Pool | None
Seen: TypeAlias = Callable[[Any, Prepared], Pool | Verdict]
Judged: TypeAlias = Callable[[Any, Prepared, Pool], Verdict]


def joined(past: Past, now: Pool, most: int = MOST) -> Pool:
    """The pieces of both, those of ``now`` from the end of ``past`` on; of more than ``most`` the oldest go.

    >>> first = Pool(np.array([1.0, 2.0]), np.zeros((2, 1)), 0.0)
    >>> joined(first, Pool(np.array([2.0, 3.0]), np.ones((2, 1)), 1.5)).at.tolist()
    [1.0, 2.0, 3.0]
    """
    if past is None or not len(past.at):
        at, rows, since = now.at, now.rows, now.since if past is None else past.since
    else:
        fresh = now.at > past.at[-1] + 0.75 * now.apart
        at, rows = np.concatenate([past.at, now.at[fresh]]), np.concatenate([past.rows, now.rows[fresh]])
        since = past.since
    if len(at) > most:
        at, rows, since = at[-most:], rows[-most:], float(at[-most - 1])
    return Pool(at, rows, since, now.apart)


def of_record(p: Any, record: LoopRecord | Prepared, seen: Seen, judged: Judged) -> Verdict:
    """The verdict on the pieces of a whole record, or its refusal."""
    loop = prepared(record)
    found = seen(p, loop)
    return found if isinstance(found, Verdict) else judged(p, loop, found)


def pooled(
    seen: Seen, judged: Judged, most: int = MOST
) -> tuple[Callable[[Any, Past, Prepared], Past], Callable[[Any, Past, Prepared], Verdict]]:
    """The functions ``remember`` and ``recall`` of a method; see the module."""

    def remember(p: Any, past: Past, loop: Prepared) -> Past:
        now = seen(p, loop)
        return None if isinstance(now, Verdict) else joined(past or None, now, most)

    def recall(p: Any, past: Past, loop: Prepared) -> Verdict:
        now = seen(p, loop)
        return now if isinstance(now, Verdict) else judged(p, loop, joined(past or None, now, most))

    return remember, recall
