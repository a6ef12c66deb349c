"""Loops of a finished scan read once more, for what only the top of the list is worth."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from stickslip.logs import LoopRecord
from stickslip.scan.loop_map import read_map
from stickslip.scan.sources import source_of
from stickslip.scan.valves import records_at

__all__ = ["read_again"]


def read_again(
    source: str | os.PathLike[str],
    out: str | os.PathLike[str],
    orders: Sequence[int],
    *,
    loop_map: str | os.PathLike[str] | None = None,
) -> Iterator[tuple[int, LoopRecord | str]]:
    """The records with these values of the column ``order``, each with its order; or why one cannot be read.

    ``source``, ``out`` and ``loop_map`` as for ``scan``.  Raises ReadError as ``scan`` does.
    """
    found = source_of(source, Path(out) / "source", () if loop_map is None else read_map(loop_map))
    yield from records_at(found, orders)
