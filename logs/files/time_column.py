"""Which column of a table is the time, and in which direction it runs."""

from __future__ import annotations

import re
from dataclasses import replace
from datetime import timedelta
from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.errors import ReadError
from stickslip.logs.files.calendar_numbers import calendar_text, clock_text
from stickslip.logs.files.clock_change import repaired_clock_change
from stickslip.logs.files.form import Form
from stickslip.logs.files.stamps import Times, parse_times
from stickslip.logs.files.table import Table
from stickslip.logs.files.time_names import is_clock_name, is_date_name, is_time_name, unit_in_name

if TYPE_CHECKING:
    import polars as pl

__all__ = ["find_times", "oldest_first"]

_STAMP = re.compile(r"\d{1,4}[-/.](\d{1,2}|[^\W\d_]{3,9})[-/.]\d{1,4}|\d{1,2}:\d{2}|^\d{4}\s?[年년]")

_DAY_LONG = len("2024-05-06")
_FEW_SHARE = 0.02  # share of rows without a time that a record can do without


def find_times(table: Table, form: Form, decimal: str) -> tuple[Table, Times, set[str], dict[str, str], list[str]]:
    """Find the columns of the time in a table, and read them.

    Returned are the rows that have a time, their times, and the columns used.  Other columns of times follow, each with
    the reason why it is not used, and notes.

    ``decimal`` is the decimal mark. A few rows without a time are left out: the record has a gap there,
    as for any missing row.

    Raises ReadError if no column is plainly the time, or the one that is cannot be read.
    """
    time, interval = form.get("time"), form.get("interval")
    frame = table.frame
    names = list(frame.columns)
    dates = [name for name in names if is_date_name(name) and _is_date(frame[name])]
    by_name = [name for name in names if is_time_name(name) or name in dates]
    by_name += [name for name in names if frame[name].dtype.is_temporal() and name not in by_name]
    aside: dict[str, str] = {}
    if time is not None and time not in names:
        raise ReadError(f"no column {time!r} for the time; the columns are {', '.join(map(repr, names[:20]))}")
    if interval is not None:
        if time is not None:
            raise ReadError("time and interval are both given; give one of them")
        if not (np.isfinite(interval) and interval > 0):
            raise ReadError(f"interval = {interval!r} s is not positive; give the seconds between rows")
        note = f"Time is not read: rows are {interval:g} s apart, as stated."
        aside |= dict.fromkeys(by_name, "the interval is stated instead")
        return table, Times(np.arange(frame.height, dtype=np.float64) * interval), set(), aside, [note]
    notes = []
    both = None if time is not None else _date_and_clock(frame)
    if both is not None:
        used, column = both
    else:
        if time is not None:
            chosen = time
        elif by_name:
            # OPC UA gives the time of the source and that of the server: the source's is when it happened.
            chosen = min(by_name, key=lambda name: ("source" not in name.casefold(), unit_in_name(name) != ""))
        elif _could_be_time(frame[names[0]], decimal):
            chosen = names[0]
            notes.append(f"The first column, {chosen!r}, is taken as the time.")
        else:
            raise ReadError(
                f"no column is plainly the time; the columns are {', '.join(map(repr, names[:20]))}: name it with "
                "time= (--time NAME), or give interval= (--interval) if the rows are evenly spaced"
            )
        used, column = {chosen}, frame[chosen]
    stated = table.units.get(next(iter(used)), "") or (unit_in_name(next(iter(used))) if len(used) == 1 else "")
    table, column, found = _with_time(table, column)
    notes += found
    times = parse_times(column, table.lines, stated, decimal, form.get("time_format"), form.get("time_unit"))
    taken = " and ".join(repr(name) for name in names if name in used)
    # Numbers under such a name may be a signal: T a temperature, hours those of a pump.
    stamps = (name for name in by_name if name not in used and _is_moment(frame[name]))
    aside |= dict.fromkeys(stamps, f"the time is {taken}")
    return table, times, used, aside, notes


def _with_time(table: Table, column: pl.Series) -> tuple[Table, pl.Series, list[str]]:
    """Table and times without the rows whose time is blank, if they are few."""
    import polars as pl

    blank = column.is_null()
    if column.dtype == pl.String:
        blank = blank | (column.alias("").str.strip_chars() == "").fill_null(True)
    count = int(blank.sum())
    if not 0 < count <= _FEW_SHARE * len(column):
        return table, column, []
    kept = [line for line, gone in zip(table.lines, blank, strict=True) if not gone]
    which = f"{count} rows have" if count > 1 else "1 row has"
    first = table.lines[blank.to_list().index(True)]
    note = f"{which} no time (first in line {first}): left out."
    return replace(table, frame=table.frame.filter(~blank), lines=kept), column.filter(~blank), [note]


def _date_and_clock(frame: pl.DataFrame) -> tuple[set[str], pl.Series] | None:
    """The columns of a date and of its clock time, if they are apart, and their stamps."""
    days = ((name, _day(frame[name])) for name in frame.columns if is_date_name(name))
    date, day = next(((name, day) for name, day in days if day is not None), ("", None))
    if day is None:
        return None
    clocks = ((name, _clock(frame[name], day)) for name in frame.columns if is_clock_name(name) and name != date)
    name, clock = next(((name, clock) for name, clock in clocks if clock is not None), ("", None))
    return None if clock is None else ({date, name}, day + " " + clock)


def _day(column: pl.Series) -> pl.Series | None:
    """The dates of a column as text, None if it holds none."""
    import polars as pl

    if _is_date(column):
        # Some spreadsheets write a midnight behind every date.
        return column.cast(pl.String).str.replace(r"[ T]+0?0:00(:00(\.0+)?)?$", "")
    calendar = calendar_text(column)
    return calendar if calendar is not None and calendar.str.len_chars().max() == _DAY_LONG else None


def _clock(column: pl.Series, day: pl.Series) -> pl.Series | None:
    """The times of day of a column as text, None if it holds none; figures alone count beside a bare day."""
    import polars as pl

    if _is_clock(column):
        return column.cast(pl.String)
    return None if day.str.contains(":").any() else clock_text(column)


def _is_date(column: pl.Series) -> bool:
    import polars as pl

    return column.dtype == pl.Date or (
        column.dtype == pl.String and bool(column.alias("").str.contains(_STAMP.pattern).any())
    )


def _is_clock(column: pl.Series) -> bool:
    import polars as pl

    if column.dtype == pl.Time:
        return True
    return column.dtype == pl.String and bool(column.alias("").str.contains(r"^\d{1,2}:\d{2}").any())


def _is_moment(column: pl.Series) -> bool:
    return column.dtype.is_temporal() or _is_date(column) or _is_clock(column)


def _could_be_time(column: pl.Series, decimal: str) -> bool:
    import polars as pl

    if column.dtype.is_temporal():
        return True
    if column.dtype == pl.String:
        if column.str.contains(_STAMP.pattern).all():
            return True
        column = column.str.replace(",", ".", literal=True) if decimal == "," else column
    elif not column.dtype.is_numeric():
        return False
    values = column.cast(pl.Float64, strict=False)
    if len(values) < 2 or values.null_count():
        return False
    steps = np.diff(values.to_numpy())
    return bool((steps > 0).all() or (steps < 0).all())


def oldest_first(table: Table, times: Times) -> tuple[Table, Times, list[str]]:
    """Table and times turned round if every row is older than the one before it, as some systems export.

    The hour that comes twice at the end of summer time may lie between. Nothing else is sorted: rows in any other order
    are refused later.
    """
    steps = np.diff(times.t)
    if (steps < 0).sum() < 2 or (np.diff(repaired_clock_change(times.t[::-1])[0]) < 0).any():
        return table, times, []
    t, start = times.t[::-1], times.start
    if start is not None:
        start, t = start + timedelta(seconds=float(t[0])), t - t[0]
    turned = replace(table, frame=table.frame.reverse(), lines=table.lines[::-1])
    note = "The rows run from the newest to the oldest: they are read the other way round."
    return turned, replace(times, t=t, start=start), [note]
