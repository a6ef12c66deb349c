"""Headers of two rows (the tag above, PV and OP below), and names that stand in a header twice."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING

from stickslip.logs.errors import ReadError
from stickslip.logs.files.lines import cells_of
from stickslip.logs.files.names import role_of
from stickslip.logs.files.time_names import is_date_name, is_time_name

if TYPE_CHECKING:
    import polars as pl

__all__ = ["with_tag_row", "without_repeats", "without_twins"]

_FIGURE = re.compile(r"\d[\d.,:]*$")


def with_tag_row(
    header: list[str], rows: list[tuple[int, str]], separator: str, notes: list[str]
) -> tuple[list[str], list[tuple[int, str]]]:
    """The header "FIC1.PV" made of two rows, "FIC1" above and "PV" below, and the rows under both.

    A cell of the upper row without a name, as a spreadsheet leaves it beside a merged one, takes the name at its left.

    >>> with_tag_row(["", "FIC1", ""], [(2, "time,PV,OP"), (3, "0,4,50")], ",", [])
    (['time', 'FIC1.PV', 'FIC1.OP'], [(3, '0,4,50')])
    """
    if not rows or len(set(header)) == len(header):
        return header, rows
    below = [cell.strip() for cell in cells_of(*rows[0], separator)]
    if len(below) != len(header) or any(_FIGURE.match(cell) for cell in below):
        return header, rows
    times = [is_time_name(cell) or is_date_name(cell) for cell in below]
    parts = sum(role_of(cell) is not None for cell in below)
    if parts < 2 or parts + sum(times) < len([cell for cell in below if cell]) / 2:
        return header, rows
    names, tag = [], ""
    for upper, lower, is_time in zip(header, below, times, strict=True):
        tag = upper or tag
        names.append(lower if is_time or not tag else f"{tag}.{lower}" if lower else tag)
    notes.append("The header has two rows, the tag above the signal.")
    return names, rows[1:]


def without_repeats(header: list[str]) -> tuple[list[str], dict[str, str]]:
    """A header without repeats, and the later name of each repeat -> the name that it repeats.

    >>> without_repeats(["time", "PV", "PV"])
    (['time', 'PV', 'PV again (column 3)'], {'PV again (column 3)': 'PV'})
    """
    seen: Counter[str] = Counter()
    names, twins = [], {}
    for column, name in enumerate(header, start=1):
        seen[name] += 1
        if seen[name] > 1:
            twins[f"{name} again (column {column})"] = name
            name = f"{name} again (column {column})"
        names.append(name)
    return names, twins


def without_twins(
    frame: pl.DataFrame, name_of: Mapping[str, str], twins: Mapping[str, str], notes: list[str]
) -> pl.DataFrame:
    """The frame without columns that repeat another, name and cells alike.

    ``name_of`` maps a header cell to its column, ``twins`` is that of ``without_repeats``. Raises ReadError if two
    columns of one name differ.
    """
    for twin, name in twins.items():
        if not frame[name_of[twin]].equals(frame[name_of[name]]):
            raise ReadError(f"the header names {name!r} more than once, over different values; rename one of them")
        frame = frame.drop(name_of[twin])
        notes.append(f"A second column {name!r} holds the same values and is passed over.")
    return frame
