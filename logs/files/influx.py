"""Exports of InfluxDB, where a signal is named by a measurement, a field and perhaps a tag, each in a column."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

from stickslip.logs.files.longform import TAGS
from stickslip.logs.files.names import role_of
from stickslip.logs.files.table import Table

__all__ = ["with_blocks_joined", "with_fields_named"]

_MEASUREMENT, _FIELD, _VALUE = "_measurement", "_field", "_value"
_BETWEEN = "\x1f"  # in no name
_HEADER = ",result,table,"  # every header of an answer begins so


def with_blocks_joined(text: str) -> str:
    """The text with one header over all its blocks, each line where it was; a text of one block as it is.

    An answer has a block, with a header of its own, for each set of columns.

    >>> with_blocks_joined(",result,table,_time,_value\\n,,0,5,4\\n\\n,result,table,_time,unit,_value\\n,,1,5,%,50\\n")
    ',result,table,_time,_value,unit\\n,,0,5,4,\\n\\n\\n,,1,5,50,%\\n'
    """
    if not text.startswith(("#", _HEADER)) or text.count(f"\n{_HEADER}") + text.startswith(_HEADER) < 2:
        return text
    lines = text.split("\n")
    headers = [_cells(line) for line in lines if line.startswith(_HEADER)]
    every = list(dict.fromkeys(name for header in headers for name in header))
    following = iter(headers)
    order: list[int | None] = []
    joined = []
    for line in lines:
        if line.startswith(_HEADER):
            header = next(following)
            order = [header.index(name) if name in header else None for name in every]
            joined.append(_line(every) if header is headers[0] else "")
        elif not line or line.startswith("#"):
            joined.append(line)
        else:
            cells = _cells(line)
            joined.append(_line(["" if at is None or at >= len(cells) else cells[at] for at in order]))
    return "\n".join(joined)


def _cells(line: str) -> list[str]:
    return next(csv.reader([line]))


def _line(cells: list[str]) -> str:
    written = io.StringIO()
    csv.writer(written, lineterminator="").writerow(cells)
    return written.getvalue()


def with_fields_named(table: Table) -> Table:
    """The table whose fields carry the name of what was measured, in front where they name no loop themselves.

    A tag beside the measurement goes before it: the measurement is then a kind, or a unit of the plant. Fields that are
    called "value" throughout say nothing and are left out.
    """
    import polars as pl

    frame = table.frame
    if not {_MEASUREMENT, _VALUE} <= set(frame.columns):
        return table
    if _FIELD not in frame.columns:
        return replace(table, frame=frame.rename({_MEASUREMENT: _FIELD}))
    beside = [name for name in frame.columns if name.casefold() in TAGS]
    owner = beside[0] if beside else _MEASUREMENT
    both = frame.select(pl.concat_str(owner, _FIELD, separator=_BETWEEN)).to_series()
    pairs = {key: key.split(_BETWEEN) for key in both.drop_nulls().unique().to_list()}
    alone = {field.casefold() for _, field in pairs.values()} <= {"value", "val", "v"}
    named = {key: _named(*pair, alone=alone) for key, pair in pairs.items()}
    joined = both.replace_strict(named, default=None, return_dtype=pl.String).fill_null(frame[_FIELD])
    return replace(table, frame=frame.with_columns(joined.alias(_FIELD)).drop(_MEASUREMENT, *beside))


def _named(owner: str, field: str, *, alone: bool) -> str:
    known = role_of(field)
    if not owner or (known is not None and known[0]):
        return field
    return owner if alone else f"{owner}.{field}"
