"""From a table of cells to a log: time, values, quality, repeats, notes."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from records.clean import decimal_mark, modes, numbers, qualities
from records.columns import is_time_name, role_of
from records.errors import ReadError
from records.heading import Heading
from records.log import Log
from records.longform import find_long_form, ordered_times, pivot
from records.stamps import Times, parse_times, repaired_clock_change
from records.states import is_blank, is_state
from records.table import Table

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Layout", "assemble", "layout_of"]

_QUALITY_ENDINGS = ("quality", "qual", "status", "good", "statuscode")
_STAMP = re.compile(r"\d{1,4}[-/.](\d{1,2}|[A-Za-z]{3,9})[-/.]\d{1,4}|\d{1,2}:\d{2}")


@dataclass(frozen=True)
class Layout:
    """Times of the rows and the names of what can be taken as a signal (columns, or tags of a long table)."""

    table: Table
    heading: Heading | None
    times: Times
    decimal: str
    names: tuple[str, ...]
    notes: tuple[str, ...]


def layout_of(
    table: Table,
    heading: Heading | None = None,
    time: str | None = None,
    decimal: str | None = None,
    time_format: str | None = None,
    interval: float | None = None,
) -> Layout:
    """Find the time and the candidates for signals. Raises ReadError if there is no time or no signal."""
    if decimal is not None and decimal not in (".", ","):
        raise ReadError(f"decimal = {decimal!r} is neither '.' nor ','; give one of them")
    if table.frame.height == 0:
        raise ReadError("the table has no rows; export a range that holds data")
    mark = decimal or ("." if heading is not None else decimal_mark(table.frame))
    notes = list(table.notes)
    if decimal is None and mark == ",":
        notes.append("Numbers are read with decimal commas.")
    times, used, found = _times(table, time, mark, time_format, interval)
    notes += [*found, *times.notes]
    long = None if heading is not None else find_long_form(table.frame.columns)
    if long is not None:
        tags = table.frame[long.tag].cast(str).unique(maintain_order=True).drop_nulls().to_list()
        return Layout(table, None, times, mark, tuple(tags), tuple(notes))
    others = [name for name in table.frame.columns if name not in used]
    if heading is not None:
        marks = set(heading.quality.values())
    else:
        marks = {name for name in others if _quality_target(name, others) is not None}
    names = tuple(name for name in others if name not in marks)
    if not names:
        raise ReadError("there is no column beside the time; export at least one signal")
    return Layout(table, heading, times, mark, names, tuple(notes))


def assemble(layout: Layout, wanted: Mapping[str, str] | None, mode: Collection[str] = ()) -> Log:
    """The log of the signals `wanted` (name in the log -> name in the file), or of all that hold numbers.

    `mode` lists the names in the file that hold controller modes. Raises ReadError if a cell is no number,
    time falls, or one time has two rows.
    """
    for signal, name in (wanted or {}).items():
        if name not in layout.names:
            shown = ", ".join(repr(known) for known in layout.names[:20])
            raise ReadError(f"no column {name!r} for {signal!r}; the columns are {shown}")
    long = None if layout.heading is not None else find_long_form(layout.table.frame.columns)
    notes = list(layout.notes)
    t, repair = layout.times.t, None
    if layout.times.start is not None and long is None:
        t, repair = repaired_clock_change(t)
    notes += [repair] if repair else []
    if long is not None:
        times = Times(t, layout.times.start)
        frame, lines = layout.table.frame, layout.table.lines
        tags = list(wanted.values()) if wanted else _with_numbers(frame, long.tag, long.value, layout.names, notes)
        result = pivot(frame, long, times, lines, layout.decimal, tags)
        t, values, notes = result.t, result.values, notes + list(result.notes)
        good = {tag: mask for tag, mask in result.good.items() if not (mask | np.isnan(values[tag])).all()}
    else:
        values, good = _columns(layout, wanted, mode, notes)
        held = [*values.values(), *(mask.astype(float) for mask in good.values())]
        t, keep, dropped = ordered_times(t, layout.table.lines, held)
        if dropped:
            notes.append(f"{dropped} repeated row{'s' * (dropped > 1)} dropped.")
            values = {name: v[keep] for name, v in values.items()}
            good = {name: mask[keep] for name, mask in good.items()}
    if layout.heading is None:
        notes += _about_sampling(t)
    name_of = {name: signal for signal, name in (wanted or {name: name for name in values}).items()}
    units = layout.heading.units if layout.heading else layout.table.units
    spans = layout.heading.spans if layout.heading else {}
    return Log(
        t=t,
        signals={name_of[name]: v for name, v in values.items()},
        units={name_of[name]: unit for name, unit in units.items() if name in values},
        spans={name_of[name]: span for name, span in spans.items() if name in values},
        quality={name_of[name]: mask for name, mask in good.items()},
        start=layout.heading.start if layout.heading else layout.times.start,
        notes=tuple(notes),
    )


def _columns(
    layout: Layout, wanted: Mapping[str, str] | None, mode: Collection[str], notes: list[str]
) -> tuple[dict[str, npt.NDArray[np.float64]], dict[str, npt.NDArray[np.bool_]]]:
    frame, lines = layout.table.frame, layout.table.lines
    values: dict[str, npt.NDArray[np.float64]] = {}
    good: dict[str, npt.NDArray[np.bool_]] = {}
    others = list(frame.columns)
    for name in wanted.values() if wanted else layout.names:
        told = role_of(name)
        is_mode = name in mode or (layout.heading is None and told is not None and told[1] == "MODE")
        if not is_mode and wanted is None and layout.heading is None and _is_text(frame[name]):
            notes.append(f"Column {name!r} holds no number and is left out.")
            continue
        own = layout.heading is not None
        if is_mode and not own:
            parsed = modes(frame[name], name)
        else:
            parsed = numbers(frame[name], name, lines, layout.decimal, keep_infinite=own)
        values[name] = parsed.values
        if layout.heading is None:
            notes += parsed.notes
        mask = parsed.good
        if layout.heading is not None:
            column = layout.heading.quality.get(name)
        else:
            column = next((other for other in others if _quality_target(other, others) == name), None)
        if column is not None and column in others:
            told_quality = qualities(frame[column], flags=own)
            if told_quality is None:
                notes.append(f"The quality in {column!r} cannot be told and is not used.")
            else:
                mask = told_quality if mask is None else mask & told_quality
                bad = int((~told_quality & ~np.isnan(parsed.values)).sum())
                if bad and layout.heading is None:
                    notes.append(f"{name}: {bad} value{'s' * (bad > 1)} of bad quality by {column!r}.")
        # Quality that says no more than "missing" is not worth keeping, except in a file of our own.
        if mask is not None and (layout.heading is not None or not mask.all()):
            good[name] = mask
    if not values:
        raise ReadError("no column beside the time holds a number; export the signals as numbers")
    return values, good


def _times(
    table: Table, time: str | None, decimal: str, time_format: str | None, interval: float | None
) -> tuple[Times, set[str], list[str]]:
    """Times, the columns they use up, and notes."""
    import polars as pl

    frame = table.frame
    names = list(frame.columns)
    by_name = [name for name in names if is_time_name(name)]
    dates = [name for name in names if name.casefold() == "date"]
    if time is not None and time not in names:
        raise ReadError(f"no column {time!r} for the time; the columns are {', '.join(map(repr, names[:20]))}")
    if interval is not None:
        if time is not None:
            raise ReadError("time and interval are both given; give one of them")
        if not (np.isfinite(interval) and interval > 0):
            raise ReadError(f"interval = {interval!r} s is not positive; give the seconds between rows")
        note = f"Time is not read: rows are {interval:g} s apart, as told."
        return Times(np.arange(frame.height, dtype=np.float64) * interval), {*by_name, *dates}, [note]
    notes = []
    if time is not None:
        chosen = time
    elif dates and by_name and frame[by_name[0]].dtype == pl.String:
        both = frame.select(pl.concat_str(dates[0], by_name[0], separator=" ")).to_series()
        return parse_times(both, table.lines, "", decimal, time_format), {dates[0], by_name[0]}, []
    elif by_name or dates:
        chosen = (by_name or dates)[0]
    elif _could_be_time(frame[names[0]], decimal):
        chosen = names[0]
        notes.append(f"The first column, {chosen!r}, is taken as the time.")
    else:
        raise ReadError(
            f"no column is plainly the time; the columns are {', '.join(map(repr, names[:20]))}: name it with "
            "time= (--time NAME), or give interval= (--interval) if the rows are evenly spaced"
        )
    times = parse_times(frame[chosen], table.lines, table.units.get(chosen, ""), decimal, time_format)
    return times, {chosen}, notes


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
    found = values.to_numpy()
    return bool((found[1:] > found[:-1]).all())


def _quality_target(column: str, columns: list[str]) -> str | None:
    """The column whose quality `column` holds, None if it is no quality column."""
    plain = {re.sub(r"[^a-z0-9]", "", name.casefold()): name for name in columns if name != column}
    folded = re.sub(r"[^a-z0-9]", "", column.casefold())
    for ending in _QUALITY_ENDINGS:
        if folded.endswith(ending) and folded.removesuffix(ending) in plain:
            return plain[folded.removesuffix(ending)]
    return None


def _is_text(column: pl.Series) -> bool:
    """Whether the column is of words that are no states, or of nothing: a comment, a unit, a tag."""
    import polars as pl

    if column.dtype != pl.String:
        return column.dtype.is_temporal() or column.null_count() == len(column)
    if column.str.contains(r"^[-+]?[\d.,]").any():
        return False
    return not any(is_state(word) and not is_blank(word) for word in column.drop_nulls().unique().to_list())


def _with_numbers(frame: pl.DataFrame, tag: str, value: str, tags: Collection[str], notes: list[str]) -> list[str]:
    import polars as pl

    kept = []
    for name in tags:
        role = role_of(name)
        if (role is None or role[1] != "MODE") and _is_text(frame.filter(pl.col(tag) == name)[value]):
            notes.append(f"Tag {name!r} holds no number and is left out.")
        else:
            kept.append(name)
    if not kept:
        raise ReadError("no tag holds a number; export the signals as numbers")
    return kept


def _about_sampling(t: npt.NDArray[np.float64]) -> list[str]:
    steps = np.diff(t)
    if len(steps) < 2:
        return []
    usual = float(np.median(steps))
    gaps = steps > 5.0 * usual
    notes = []
    if gaps.any():
        count = int(gaps.sum())
        notes.append(f"{count} gap{'s' * (count > 1)} in time, the longest {steps.max():.6g} s.")
    rest = steps[~gaps]
    if rest.max() > 1.5 * rest.min():
        notes.append(f"Sampling is uneven: {rest.min():.4g} to {rest.max():.4g} s apart, {usual:.4g} s as a rule.")
    return notes
