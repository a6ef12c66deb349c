"""Long tables (tag, time, value[, quality]) turned into one column a tag."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from stickslip.logs.files.carried import carried, is_held
from stickslip.logs.files.clean import modes, numbers
from stickslip.logs.files.names import role_of
from stickslip.logs.files.order import ordered_times
from stickslip.logs.files.quality import bad_values, qualities
from stickslip.logs.files.size import check_cells

if TYPE_CHECKING:
    import polars as pl

__all__ = ["TAGS", "LongColumns", "LongRows", "Pivot", "find_long_form", "pivot"]

TAGS = {
    "tag", "tagname", "name", "point", "pointname", "variable", "signal", "sensor", "tagid", "item", "path", "varname",
    "itemid", "datasource", "tagpath", "field", "nodeid", "pointid", "kks", "messstelle",
}  # fmt: skip
_VALUES = {"value", "val", "data", "reading", "v", "varvalue", "wert", "valeur", "valor", "verdi"}
_QUALITIES = {
    "quality", "status", "qual", "statuscode", "confidence", "conf", "good", "q", "validity", "opcquality",
    "qualitydetail", "qualitycode", "opcqualityid",
}  # fmt: skip


@dataclass(frozen=True)
class LongColumns:
    """The columns of a long table that hold the tag, the value and the quality."""

    tag: str
    value: str
    quality: str | None

    @property
    def columns(self) -> tuple[str | None, ...]:
        """All of them."""
        return self.tag, self.value, self.quality


@dataclass(frozen=True)
class Pivot:
    """Signals on one time axis, with True where a value is good."""

    t: npt.NDArray[np.float64]
    values: dict[str, npt.NDArray[np.float64]]
    good: dict[str, npt.NDArray[np.bool_]]
    notes: tuple[str, ...]


def find_long_form(columns: list[str]) -> LongColumns | None:
    """The tag and value columns if the table is long, else None.

    >>> find_long_form(["TagName", "Timestamp", "Value", "Quality"])
    LongColumns(tag='TagName', value='Value', quality='Quality')
    >>> find_long_form(["time", "PV", "OP"]) is None
    True
    """
    plain = {re.sub(r"[^a-z]", "", column.casefold()): column for column in columns}
    tag = next((plain[word] for word in plain if word in TAGS), None)
    value = next((plain[word] for word in plain if word in _VALUES), None)
    if tag is None or value is None:
        return None
    return LongColumns(tag, value, next((plain[word] for word in plain if word in _QUALITIES), None))


@dataclass(frozen=True)
class LongRows:
    """The rows of each tag, in their order; ``good`` is True where the quality is good, None where a file has none."""

    of_tag: dict[str, npt.NDArray[np.intp]]
    good: npt.NDArray[np.bool_] | None

    @classmethod
    def of(cls, frame: pl.DataFrame, long: LongColumns) -> LongRows:
        """The rows of a long table."""
        import polars as pl

        which = frame[long.tag].alias("tag").cast(pl.String).to_frame().with_row_index("row")
        groups = which.group_by("tag", maintain_order=True).agg("row")
        rows = {tag: rows.to_numpy().astype(np.intp) for tag, rows in zip(groups["tag"], groups["row"], strict=True)}
        return cls(rows, None if long.quality is None else qualities(frame[long.quality], long.quality))


def pivot(
    frame: pl.DataFrame,
    long: LongColumns,
    rows_of: LongRows,
    clock: npt.NDArray[np.float64],
    lines: list[int],
    decimal: str,
    tags: list[str],
) -> Pivot:
    """The signals of ``tags`` on the union of their times.

    A tag reported at other times than the rest is carried over: SP, OP and MODE hold their last report, all
    else is joined by straight lines between good reports.

    Raises ReadError if one tag has two values at one time or its rows are not in time order.
    """
    quality = rows_of.good
    series: dict[str, tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.bool_]]] = {}
    notes: list[str] = []
    if long.quality is not None and quality is None:
        notes.append(f"The quality in {long.quality!r} cannot be recognised and is not used.")
    for tag in tags:
        rows = rows_of.of_tag[tag]
        own_lines = [lines[row] for row in rows]
        part = frame[rows]
        role = role_of(tag)
        if role is not None and role[1] == "MODE":
            parsed = modes(part[long.value], tag)
        else:
            parsed = numbers(part[long.value], tag, own_lines, decimal)
        good = parsed.good if parsed.good is not None else np.ones(len(rows), dtype=bool)
        if quality is not None:
            good = good & quality[rows]
            notes += bad_values(tag, str(long.quality), quality[rows], parsed.values)
        t, keep, found = ordered_times(clock[rows], own_lines, [parsed.values, good.astype(float)], tag)
        notes += [f"{tag}: {note}" for note in found]
        notes += parsed.notes
        series[tag] = (t, parsed.values[keep], good[keep])
    axis = np.unique(np.concatenate([t for t, _, _ in series.values()]))
    check_cells(len(axis), len(series), "tags")
    values, masks = {}, {}
    for tag, (t, own, good) in series.items():
        held = is_held(tag)
        values[tag], masks[tag] = carried(axis, t, own, good, held=held)
        missing = len(axis) - len(t)
        if missing:
            how = "held from the report before" if held else "on the line between reports"
            notes.append(f"{tag}: reported at {len(t)} of {len(axis)} times, {how} at the others.")
    return Pivot(axis, values, masks, tuple(notes))
