"""Tables in which every signal has a time column of its own in front of it."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from stickslip.logs.files.time_names import is_time_name

if TYPE_CHECKING:
    import polars as pl

__all__ = ["is_paired", "long_from_pairs", "numbered_pairs", "with_times_named"]

_MARK = "\x1f"  # stands between the name of a repeated time column and its number; no file has it in a name


def is_paired(header: list[str]) -> bool:
    """Whether one name of a time comes more than once, each time with signals behind it.

    >>> is_paired(["Time", "FIC1.PV", "Time", "FIC1.OP"]), is_paired(["Time", "PV", "OP"])
    (True, False)
    """
    times = [i for i, name in enumerate(header) if name == header[0] and is_time_name(name)]
    return len(times) > 1 and all(after - before > 1 for before, after in pairwise([*times, len(header)]))


def with_times_named(header: list[str], first: list[str]) -> list[str]:
    """The header of pairs whose tag stands above the time and nothing above the value, with a name for each.

    ``first`` is the first row below it.

    >>> with_times_named(["FIC1.PV", "", "FIC1.OP", ""], ["2024-05-06 07:00", "4", "2024-05-06 07:00", "50"])
    ['Time', 'FIC1.PV', 'Time', 'FIC1.OP']
    """
    tags, blanks = header[0::2], header[1::2]
    if len(header) < 4 or len(header) % 2 or not all(tags) or any(blanks) or len(first) != len(header):
        return header
    if not all(":" in cell for cell in first[0::2]) or any(":" in cell for cell in first[1::2]):
        return header
    return [name for tag in tags for name in ("Time", tag)]


def numbered_pairs(header: list[str]) -> list[str]:
    """The header with its time columns numbered."""
    return [f"{name}{_MARK}{i}" if name == header[0] else name for i, name in enumerate(header)]


def long_from_pairs(frame: pl.DataFrame, lines: list[int]) -> tuple[pl.DataFrame, list[int]]:
    """Return a table with one value a row (columns "tag", "time", "value") and the line that each row comes from.

    Rows in which a signal has no time any more, because it has fewer values than others, are left out.
    """
    import polars as pl

    parts, time = [], frame.columns[0]
    for name in frame.columns:
        if _MARK in name:
            time = name
            continue
        part = pl.DataFrame({"time": frame[time], "value": frame[name], "line": lines}).with_columns(tag=pl.lit(name))
        parts.append(part.filter(pl.col("time").fill_null("") != ""))
    long = pl.concat(parts)
    return long.drop("line"), long["line"].to_list()
