"""A table in memory as a log, exactly as it stands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.logs.errors import LogError
from stickslip.logs.log import Log


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
        from stickslip.logs.files.frames import polars_frame

        frame = polars_frame(table)
        kept = [name for name in frame.columns if name == "time" or frame[name].dtype.is_numeric()]
        table = {name: frame[name].to_numpy() for name in kept}
    if "time" not in table:
        raise LogError(
            f"the table has no column 'time', only {', '.join(map(repr, table)) or 'none'}; name its time [s] so, or "
            "read it with stickslip.logs.read_log, which finds the time"
        )
    signals = {name: np.asarray(values) for name, values in table.items() if name != "time"}
    return Log(table["time"], signals, {name: unit for name, unit in units.items() if name in signals})
