"""Calendar times written without any mark between their parts: 20240506, 202405060700, 20240506070000."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl

__all__ = ["calendar_text", "with_marks"]

_DAY = r"^(\d{4})(\d{2})(\d{2})"
# The years that counts since a date are looked for in: no such count has as many digits and these in front.
_NUMBER = r"^(199[5-9]|20[0-5]\d)(0[1-9]|1[0-2])(0[1-9]|[12]\d|3[01])(([01]\d|2[0-3])[0-5]\d([0-5]\d([.,]\d+)?)?)?$"


def with_marks(text: pl.Series) -> pl.Series:
    """The stamps with marks between year, month, day, hour, minute and second where there are none.

    >>> import polars as pl
    >>> with_marks(pl.Series(["20240506T070000Z", "202405060700", "2024-05-06"])).to_list()
    ['2024-05-06 07:00:00Z', '2024-05-06 07:00', '2024-05-06']
    """
    text = text.str.replace(_DAY + r"[T ]?(\d{2}):?(\d{2}):?(\d{2})", "${1}-${2}-${3} ${4}:${5}:${6}")
    text = text.str.replace(_DAY + r"[T ]?(\d{2}):?(\d{2})$", "${1}-${2}-${3} ${4}:${5}")
    return text.str.replace(_DAY + "$", "${1}-${2}-${3}")


def calendar_text(column: pl.Series) -> pl.Series | None:
    """The stamps with marks if every number of the column reads as a calendar date of 1995 to 2059, else None.

    Counts since 1970, 1601 or the year 1 have other numbers of digits, or more in front.

    >>> import polars as pl
    >>> calendar_text(pl.Series([20240506070000, 20240506070010])).to_list()
    ['2024-05-06 07:00:00', '2024-05-06 07:00:10']
    >>> calendar_text(pl.Series([1714978800, 1714978810])) is None
    True
    """
    import polars as pl

    if column.dtype.is_float():
        whole = column.cast(pl.Int64, strict=False)
        if whole.null_count() or not (whole == column).all():
            return None
        column = whole
    text = column.cast(pl.String)
    if text.null_count() or not text.str.contains(_NUMBER).all():
        return None
    marked = with_marks(text)
    days = marked.str.slice(0, 10).str.strptime(pl.Date, "%Y-%m-%d", strict=False)
    return None if days.null_count() else marked
