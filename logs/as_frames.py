"""A log as a data frame of pandas or polars, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from logs.errors import LogError
from logs.log import Log

if TYPE_CHECKING:
    import polars as pl


def to_pandas(log: Log) -> Any:
    """Return a ``pandas.DataFrame``: one column a signal, the index is the time [s], ``attrs["units"]`` the units.

    Raises ``ImportError`` that says what to install if pandas is not there.
    """
    try:
        import pandas as pd
    except ImportError:
        raise ImportError(
            "to_pandas needs pandas, which is not installed; pip install pandas, or use to_polars()"
        ) from None
    frame = pd.DataFrame(dict(log.signals), index=pd.Index(log.t, name="time"))
    frame.attrs["units"] = dict(log.units)
    return frame


def to_polars(log: Log) -> pl.DataFrame:
    """Return a ``polars.DataFrame``: the column ``time`` [s] and one column a signal."""
    import polars as pl

    return pl.DataFrame({"time": log.t, **log.signals})


def from_table(table: Any) -> Log:
    """Return a table in memory as a log, exactly as it stands: a frame, or a mapping of arrays, with a ``time`` [s].

    Columns that hold no numbers are left out; a frame of pandas has its units in ``attrs["units"]``.  A file, or a
    table whose time has another name or unit, is for ``read_log``, which finds out what its columns are.

    Raises ``LogError`` without a column ``time``, or for columns that make no log.

    >>> from_table({"time": [0.0, 1.0], "OP": [50.0, 51.0]})
    <Log of 2 samples over 1 s: OP>
    """
    units = getattr(table, "attrs", {}).get("units", {})
    if not isinstance(table, Mapping):
        from logs.files.frames import polars_frame

        frame = polars_frame(table)
        kept = [name for name in frame.columns if name == "time" or frame[name].dtype.is_numeric()]
        table = {name: frame[name].to_numpy() for name in kept}
    if "time" not in table:
        raise LogError(
            f"the table has no column 'time', only {', '.join(map(repr, table)) or 'none'}; name its time [s] so, or "
            "read it with logs.read_log, which finds the time"
        )
    signals = {name: np.asarray(values) for name, values in table.items() if name != "time"}
    return Log(table["time"], signals, {name: unit for name, unit in units.items() if name in signals})
