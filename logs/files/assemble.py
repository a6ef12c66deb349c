"""From a table of cells to a log: time, values, quality, repeats, notes."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from stickslip.logs.errors import ReadError
from stickslip.logs.files.carried import carried_over
from stickslip.logs.files.clean import decimal_mark, modes, numbers
from stickslip.logs.files.clock_change import repaired_clock_change, repaired_in_tags
from stickslip.logs.files.form import Form
from stickslip.logs.files.grouping import Columns
from stickslip.logs.files.heading import Heading
from stickslip.logs.files.longform import LongColumns, LongRows, find_long_form, pivot
from stickslip.logs.files.names import role_of
from stickslip.logs.files.order import about_sampling, ordered_times
from stickslip.logs.files.quality import bad_values, qualities, quality_columns
from stickslip.logs.files.stamps import Times
from stickslip.logs.files.states import is_blank, is_state
from stickslip.logs.files.table import Table
from stickslip.logs.files.time_column import find_times, oldest_first
from stickslip.logs.log import Log
from stickslip.logs.loop_signals import LoopSignals, renamed, within

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Layout", "assemble", "layout_of"]

_FIGURE = re.compile(r"[-+]?[\d.,]")


@dataclass(frozen=True)
class Layout:
    """Times of the rows and the names of what can be taken as a signal (columns, or tags of a long table).

    Work that is the same for every loop of a file is done once.
    """

    table: Table
    heading: Heading | None
    times: Times
    decimal: str
    columns: Columns
    notes: tuple[str, ...]
    marks: Mapping[str, tuple[str, ...]]  # quality column -> signals whose quality it holds
    aside: Mapping[str, str]  # column that cannot be a signal -> why
    long: LongColumns | None

    @property
    def names(self) -> tuple[str, ...]:
        """The candidates for signals, in the order of the file."""
        return self.columns.names

    @cached_property
    def clock(self) -> tuple[npt.NDArray[np.float64], str | None]:
        """Times of the rows [s], and what was repaired in them."""
        t, start = self.times.t, self.times.start
        if start is None:
            return t, None
        if self.long_rows is not None:
            return repaired_in_tags(t, start, self.long_rows.of_tag)
        return repaired_clock_change(t, start)

    @cached_property
    def long_rows(self) -> LongRows | None:
        """The rows of each tag of a long table."""
        return None if self.long is None else LongRows.of(self.table.frame, self.long)

    @cached_property
    def marks_of(self) -> dict[str, list[str]]:
        """Signal -> the columns that hold its quality."""
        if self.heading is not None:
            there = set(self.table.frame.columns)
            return {name: [column] for name, column in self.heading.quality.items() if column in there}
        found: dict[str, list[str]] = {}
        for column, signals in self.marks.items():
            for name in signals:
                found.setdefault(name, []).append(column)
        return found

    @cached_property
    def noted(self) -> dict[str, list[tuple[int, str, LoopSignals]]]:
        """PV -> the loops of it that the file itself notes: place in the heading, tag, signals."""
        found: dict[str, list[tuple[int, str, LoopSignals]]] = {}
        for place, (tag, loop) in enumerate(self.heading.loops.items() if self.heading is not None else ()):
            found.setdefault(loop.pv, []).append((place, tag, loop))
        return found


def layout_of(table: Table, heading: Heading | None = None, form: Form | None = None) -> Layout:
    """Find the time and the candidates for signals. Raises ReadError if there is no time or no signal."""
    form = form or {}
    decimal = form.get("decimal")
    if decimal is not None and decimal not in (".", ","):
        raise ReadError(f"decimal = {decimal!r} is neither '.' nor ','; give one of them")
    if table.frame.height == 0:
        raise ReadError("the table has no rows; export a range that holds data")
    mark = decimal or ("." if heading is not None else decimal_mark(table.frame))
    notes = list(table.notes)
    if decimal is None and mark == ",":
        notes.append("Numbers are read with decimal commas.")
    own = heading is not None
    if own and form.get("interval") is None:
        form = {**form, "time": "time"}
    table, times, used, aside, found = find_times(table, form, mark)
    if own:  # whatever its name, every other column is a signal
        aside = {name: why for name, why in aside.items() if name == "time"}
    notes += [*found, *times.notes]
    if not own:
        table, times, found = oldest_first(table, times)
        notes += found
    others = [name for name in table.frame.columns if name not in used and name not in aside]
    long = None if own else find_long_form(others)
    marks: dict[str, tuple[str, ...]] = {}
    if long is not None:
        names = table.frame[long.tag].cast(str).unique(maintain_order=True).drop_nulls().to_list()
        aside |= {name: "no part of a long table" for name in others if name not in long.columns}
    elif heading is not None:
        names = [name for name in others if name not in heading.quality.values()]
    else:
        marks = quality_columns(others)
        names = [name for name in others if name not in marks]
    if not names:
        raise ReadError("there is no column beside the time; export at least one signal")
    return Layout(table, heading, times, mark, Columns(names), tuple(notes), marks, aside, long)


def assemble(layout: Layout, wanted: Mapping[str, str] | None, mode: Collection[str] = ()) -> Log:
    """The log of the signals ``wanted`` (name in the log -> name in the file), or of all that hold numbers.

    ``mode`` lists the names in the file that hold controller modes. Raises ReadError if a cell is no number,
    time falls, or one time has two rows.
    """
    for signal, name in (wanted or {}).items():
        if name not in layout.columns:
            shown = ", ".join(repr(known) for known in layout.names[:20])
            raise ReadError(f"no column {name!r} for {signal!r}; the columns are {shown}")
    long = layout.long
    notes = list(layout.notes)
    t, repair = layout.clock
    notes += [repair] if repair else []
    if long is not None and layout.long_rows is not None:
        frame, lines = layout.table.frame, layout.table.lines
        tags = list(wanted.values()) if wanted else _with_numbers(frame, long.tag, long.value, layout.names, notes)
        result = pivot(frame, long, layout.long_rows, t, lines, layout.decimal, tags)
        t, values, notes = result.t, result.values, notes + list(result.notes)
        good = {tag: mask for tag, mask in result.good.items() if not (mask | np.isnan(values[tag])).all()}
    else:
        values, good = _columns(layout, wanted, mode, notes)
        if layout.heading is None:
            carried_over(t, values, good, notes)
        held = [*values.values(), *(mask.astype(float) for mask in good.values())]
        t, keep, found = ordered_times(t, layout.table.lines, held)
        notes += found
        if not np.array_equal(keep, np.arange(layout.table.frame.height)):
            values = {name: v[keep] for name, v in values.items()}
            good = {name: mask[keep] for name, mask in good.items()}
    if layout.heading is None:
        notes += about_sampling(t, guessed=layout.times.guessed)
    name_of = {name: signal for signal, name in (wanted or {name: name for name in values}).items()}
    units = layout.heading.units if layout.heading else layout.table.units
    noted = sorted((one for name in values for one in layout.noted.get(name, ())), key=lambda one: one[0])
    spans = layout.heading.spans if layout.heading else {}
    return Log(
        t=t,
        signals={name_of[name]: v for name, v in values.items()},
        units={name_of[name]: units[name] for name in values if name in units},
        spans={name_of[name]: spans[name] for name in values if name in spans},
        quality={name_of[name]: mask for name, mask in good.items()},
        start=layout.heading.start if layout.heading else layout.times.start,
        notes=tuple(notes),
        loops=renamed(within({tag: loop for _, tag, loop in noted}, values), name_of),
    )


def _columns(
    layout: Layout, wanted: Mapping[str, str] | None, mode: Collection[str], notes: list[str]
) -> tuple[dict[str, npt.NDArray[np.float64]], dict[str, npt.NDArray[np.bool_]]]:
    frame, lines = layout.table.frame, layout.table.lines
    values: dict[str, npt.NDArray[np.float64]] = {}
    good: dict[str, npt.NDArray[np.bool_]] = {}
    unclear: dict[str, str] = {}
    for name in wanted.values() if wanted else layout.names:
        known = role_of(name)
        is_mode = name in mode or (layout.heading is None and known is not None and known[1] == "MODE")
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
        for column in layout.marks_of.get(name, ()):
            quality = qualities(frame[column], column, flags=own)
            if quality is None:
                unclear[column] = f"The quality in {column!r} cannot be recognised and is not used."
                continue
            mask = quality if mask is None else mask & quality
            if not own:
                notes += bad_values(name, column, quality, parsed.values)
        # Quality that says no more than "missing" is not worth keeping, except in a file of our own.
        if mask is not None and (layout.heading is not None or not mask.all()):
            good[name] = mask
    notes += unclear.values()
    if not values:
        raise ReadError("no column beside the time holds a number; export the signals as numbers")
    return values, good


def _is_text(column: pl.Series) -> bool:
    """Whether the column is of words that are no states, or of nothing: a comment, a unit, a tag."""
    import polars as pl

    column = column.alias("")
    if column.dtype != pl.String:
        return not (column.dtype.is_numeric() or column.dtype == pl.Boolean) or column.null_count() == len(column)
    first = column[0] if len(column) else None
    if first is not None and _FIGURE.match(first):
        return False
    if column.str.contains(f"^{_FIGURE.pattern}").any():
        return False
    return not any(is_state(word) and not is_blank(word) for word in column.drop_nulls().unique().to_list())


def _with_numbers(frame: pl.DataFrame, tag: str, value: str, tags: Collection[str], notes: list[str]) -> list[str]:

    kept = []
    cells = {str(key[0]): part[value] for key, part in frame.select(tag, value).partition_by(tag, as_dict=True).items()}
    for name in tags:
        role = role_of(name)
        if (role is None or role[1] != "MODE") and _is_text(cells[name]):
            notes.append(f"Tag {name!r} holds no number and is left out.")
        else:
            kept.append(name)
    if not kept:
        raise ReadError("no tag holds a number; export the signals as numbers")
    return kept
