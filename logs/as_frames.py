"""Signals as a data frame of pandas or polars."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.logs.signals import Signals

if TYPE_CHECKING:
    import polars as pl


def to_pandas(log: Signals) -> Any:
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


def to_polars(log: Signals) -> pl.DataFrame:
    """Return a ``polars.DataFrame``: the column ``time`` [s] and one column a signal."""
    import polars as pl

    return pl.DataFrame({"time": log.t, **log.signals})
