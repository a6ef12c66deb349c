"""Exports of InfluxDB, where a signal is named by a measurement, a field and perhaps a tag, each in a column."""

from __future__ import annotations

from dataclasses import replace

from stickslip.logs.files.longform import TAGS
from stickslip.logs.files.names import role_of
from stickslip.logs.files.table import Table

__all__ = ["with_fields_named"]

_MEASUREMENT, _FIELD, _VALUE = "_measurement", "_field", "_value"
_BETWEEN = "\x1f"  # in no name


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
