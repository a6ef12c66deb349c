"""Data frames of other libraries as one of polars: pandas, pyarrow, and all that speak Arrow or the exchange protocol.

A response of python-control is one too: its time, outputs and inputs.

None of these libraries is imported: their objects are known by what they can do.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.logs.errors import ReadError

if TYPE_CHECKING:
    import polars as pl

__all__ = ["frame_kind", "polars_frame"]

_ONE_COLUMN = "this is a single column; give a frame with a time and the signals of a loop"


def frame_kind(source: object) -> str:
    """What ``source`` is a frame of, "" for a path or anything else that is no frame.

    >>> import polars as pl
    >>> frame_kind(pl.DataFrame({"PV": [1.0]})), frame_kind("trend.csv")
    ('polars', '')
    """
    library = type(source).__module__.split(".")[0]
    if library == "polars" and (hasattr(source, "collect_schema") or hasattr(source, "get_columns")):
        return "polars"
    if hasattr(source, "iloc") and hasattr(source, "reset_index") and hasattr(source, "columns"):
        return "pandas"
    if hasattr(source, "__arrow_c_stream__") or hasattr(source, "__dataframe__"):
        return library
    return "python-control" if hasattr(source, "output_labels") and hasattr(source, "ntraces") else ""


def polars_frame(source: Any) -> pl.DataFrame:
    """The frame as one of polars; an index that tells something becomes a column.

    Raises ReadError if two columns have one name, or the frame has fewer than two columns.
    """
    import polars as pl

    kind = frame_kind(source)
    if kind == "polars":
        frame = source.collect() if isinstance(source, pl.LazyFrame) else source
    elif kind == "pandas":
        frame = _from_pandas(source)
    elif kind == "python-control":
        frame = pl.DataFrame(_columns_of_response(source))
    elif hasattr(source, "__arrow_c_stream__"):
        frame = pl.DataFrame(source)
    else:
        frame = pl.from_dataframe(source)
    if not isinstance(frame, pl.DataFrame):
        raise ReadError(_ONE_COLUMN)
    if frame.width < 2:
        raise ReadError(f"the frame has {frame.width} column; a record needs a time and a signal")
    return frame


def _columns_of_response(source: Any) -> dict[str, Any]:
    """Time [s], outputs and those inputs that are no outputs of a response of python-control."""
    if source.ntraces > 1:
        raise ReadError(f"the response has {source.ntraces} traces; give one of them, e.g. response[:, 0]")
    columns = {"time": np.asarray(source.time)}
    for labels, rows in ((source.output_labels, source.y), (source.input_labels, source.u)):
        if labels and rows is not None:
            for label, row in zip(labels, np.reshape(rows, (len(labels), -1)), strict=True):
                columns.setdefault(label, row)
    return columns


def _from_pandas(source: Any) -> pl.DataFrame:
    import polars as pl

    if not hasattr(source, "columns"):
        raise ReadError(_ONE_COLUMN)
    # An index that only counts the rows from 0 says nothing; any other is most often the time.
    if type(source.index).__name__ != "RangeIndex":
        unnamed = source.index.nlevels == 1 and source.index.name is None
        source = source.reset_index()
        if unnamed:
            source = source.rename(columns={source.columns[0]: _free_name(source)})
    names = [_name(column) for column in source.columns]
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        raise ReadError(f"the frame names {', '.join(map(repr, twice))} more than once; rename one of them")
    return pl.DataFrame([_series(name, source.iloc[:, i]) for i, name in enumerate(names)])


def _free_name(source: Any) -> str:
    kind = getattr(source.iloc[:, 0].dtype, "kind", "O")
    return "index" if kind in "iu" or "time" in source.columns else "time"


def _name(column: object) -> str:
    """A column's name; the levels of several, such as ("FIC1", "PV"), are joined by a point."""
    if isinstance(column, tuple):
        return ".".join(str(level) for level in column if str(level))
    return str(column)


def _series(name: str, column: Any) -> pl.Series:
    import polars as pl

    kind = getattr(column.dtype, "kind", "O")
    if kind in "Mm" and getattr(column.dtype, "tz", None) is None:
        return pl.Series(name, column.to_numpy().astype(f"{kind}8[ns]"))
    if kind == "M":
        utc = column.dt.tz_convert("UTC").dt.tz_localize(None).to_numpy().astype("M8[ns]")
        return pl.Series(name, utc).dt.replace_time_zone("UTC")
    if kind in "iufb" and not column.isna().any():
        return pl.Series(name, column.to_numpy(dtype={"b": np.bool_, "f": np.float64}.get(kind, np.int64)))
    if kind in "iuf":
        return pl.Series(name, column.to_numpy(dtype=np.float64, na_value=np.nan))
    missing = column.isna().to_numpy()
    cells = column.to_numpy(dtype=object)
    text = [None if gone else str(cell) for cell, gone in zip(cells, missing, strict=True)]
    return pl.Series(name, text, dtype=pl.String)
