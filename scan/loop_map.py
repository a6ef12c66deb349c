"""A loop map: which tags make up which loop if their names do not show it, and what is known of the loop."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, get_args

from stickslip.logs import LoopRecord, ReadError, read_loop
from stickslip.logs.tags import Process

__all__ = ["COLUMNS", "LoopTags", "read_map"]

COLUMNS = ("loop", "pv", "op", "sp", "mv", "mode", "process", "op_low", "op_high", "unit")


@dataclass(frozen=True)
class LoopTags:
    """The tags of one loop.

    loop, pv, op : str
    sp, mv, mode : str or None
        None where there is none.
    process : {"self_regulating", "integrating", "unknown"} or None
        None: recognised by the tag.
    op_span : (low, high) or None
        Span of OP in its unit.
    unit : str
        Part of the plant, for grouping; "" if none.

    >>> LoopTags("FIC1", pv="FT1", op="FCV1").columns
    ('FT1', 'FCV1')
    """

    loop: str
    pv: str
    op: str
    sp: str | None = None
    mv: str | None = None
    mode: str | None = None
    process: Process | None = None
    op_span: tuple[float, float] | None = None
    unit: str = ""

    @property
    def columns(self) -> tuple[str, ...]:
        """All tags of the loop."""
        return tuple(tag for tag in (self.pv, self.op, self.sp, self.mv, self.mode) if tag)

    def read(self, source: Any) -> LoopRecord:
        """The record of this loop from a file or a data frame. Raises ReadError as ``read_loop`` does."""
        return read_loop(
            source, pv=self.pv, op=self.op, sp=self.sp or "", mv=self.mv or "", mode=self.mode or "", name=self.loop,
            process=self.process, op_span=self.op_span,
        )  # fmt: skip


def read_map(path: str | os.PathLike[str]) -> tuple[LoopTags, ...]:
    """The loops of a CSV file with the columns loop, pv, op and, where known, the others of ``COLUMNS``.

    Raises ReadError if it cannot be read, a needed cell is empty, or a loop stands in it twice.
    """
    import polars as pl

    name = os.fspath(path)
    try:
        frame = pl.read_csv(name, infer_schema=False)
    except (pl.exceptions.PolarsError, OSError) as fault:
        raise ReadError(f"{name}: the loop map cannot be read ({fault}); give a CSV file with a header") from None
    names = [column.strip().casefold() for column in frame.columns]
    missing = [column for column in ("loop", "pv", "op") if column not in names]
    other = [column for column in names if column not in COLUMNS]
    if missing or other:
        wrong = f"has no column {missing[0]!r}" if missing else f"has a column {other[0]!r} that means nothing here"
        raise ReadError(f"{name}: the loop map {wrong}; its columns are {', '.join(COLUMNS)}")
    frame = frame.rename(dict(zip(frame.columns, names, strict=True)))
    found: dict[str, LoopTags] = {}
    for line, row in enumerate(frame.iter_rows(named=True), start=2):
        tags = _tags({key: (value or "").strip() for key, value in row.items()}, f"{name}: line {line}")
        if tags.loop in found:
            raise ReadError(f"{name}: line {line} names the loop {tags.loop!r} again; name it once")
        found[tags.loop] = tags
    if not found:
        raise ReadError(f"{name}: the loop map has a header and no loop; add a row for each")
    return tuple(found.values())


def _tags(row: dict[str, str], where: str) -> LoopTags:
    for column in ("loop", "pv", "op"):
        if not row[column]:
            raise ReadError(f"{where} has no {column}; every loop needs a name, a PV and an OP")
    process = row.get("process") or None
    if process is not None and process not in get_args(Process):
        raise ReadError(f"{where}: process = {process!r}; give one of {', '.join(get_args(Process))}")
    span = None
    if row.get("op_low") or row.get("op_high"):
        try:
            span = float(row.get("op_low", "")), float(row.get("op_high", ""))
        except ValueError:
            raise ReadError(f"{where}: op_low and op_high are two numbers, or both blank") from None
        if not span[0] < span[1]:
            raise ReadError(f"{where}: op_low = {span[0]:g} is not below op_high = {span[1]:g}")
    return LoopTags(
        row["loop"], row["pv"], row["op"], row.get("sp") or None, row.get("mv") or None, row.get("mode") or None,
        process, span, row.get("unit", ""),  # type: ignore[arg-type]  # checked above
    )  # fmt: skip
