"""Exports of InfluxDB, where a signal is named by a measurement, a field and perhaps a tag, each in a column."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from logs.files.names import role_of
from logs.files.table import Table

if TYPE_CHECKING:
    import polars as pl

__all__ = ["with_fields_named"]

_MEASUREMENT, _FIELD = "_measurement", "_field"


def with_fields_named(table: Table, tags: frozenset[str]) -> Table:
    """The table whose fields carry the name of what was measured; ``tags`` are names of columns that hold tags.

    A field that names a loop stays as it is; one that is called "value" throughout says nothing and is left out.
    """
    import polars as pl

    frame = table.frame
    if _FIELD not in frame.columns or _MEASUREMENT not in frame.columns:
        return table
    beside = [name for name in frame.columns if name.casefold() in tags]
    owner = beside[0] if beside else _MEASUREMENT
    pairs = frame.select(owner, _FIELD).unique(maintain_order=True)
    fields = pairs[_FIELD].drop_nulls().unique().to_list()
    alone = len(fields) == 1 and fields[0].casefold() in ("value", "val", "v")
    named = [_named(*pair, alone=alone) for pair in pairs.iter_rows()]
    key = pairs.with_columns(pl.Series("_name", named, dtype=pl.String))
    joined = frame.join(key, on=[owner, _FIELD], how="left", nulls_equal=True, maintain_order="left")["_name"]
    frame = frame.with_columns(joined.alias(_FIELD)).drop(_MEASUREMENT, *beside)
    return replace(table, frame=frame)


def _named(owner: str | None, field: str | None, *, alone: bool) -> str | None:
    told = role_of(field) if field else None
    if not owner or not field or (told is not None and told[0]):
        return field
    return owner if alone else f"{owner}.{field}"
