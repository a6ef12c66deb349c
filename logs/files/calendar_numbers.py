"""Calendar times written without marks between their parts, or with words for marks: 20240506, 2024年5月6日."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl

__all__ = ["calendar_text", "clock_text", "with_marks"]

_DAY = r"^(\d{4})(\d{2})(\d{2})"
_HALF_DAY = r"(上午|下午|午前|午後|오전|오후)\s*(.*)$"  # stands before the hour
_WORDED = (  # year, month and day, hour, minute and second as Chinese, Japanese and Korean write them
    (r"^(\d{4})\s*[年년]\s*(\d{1,2})\s*[月월]\s*(\d{1,2})\s*[日号號일]?\s*", "${1}-${2}-${3} "),
    (r"\s*[时時点點시：]\s*", ":"),
    (r"\s*[分분：]\s*", ":"),
    (r"\s*[秒초]|:$", ""),
    (r" (\d{1,2})$", " ${1}:00"),
)
# The years that counts since a date are looked for in: no such count has as many digits and these in front.
_NUMBER = r"^(199[5-9]|20[0-5]\d)(0[1-9]|1[0-2])(0[1-9]|[12]\d|3[01])(([01]\d|2[0-3])[0-5]\d([0-5]\d([.,]\d+)?)?)?$"


def with_marks(text: pl.Series) -> pl.Series:
    """The stamps with marks between year, month, day, hour, minute and second where there are none.

    >>> import polars as pl
    >>> with_marks(pl.Series(["20240506T070000Z", "202405060700", "2024-05-06"])).to_list()
    ['2024-05-06 07:00:00Z', '2024-05-06 07:00', '2024-05-06']
    >>> with_marks(pl.Series(["2024年5月6日 下午7:00:00", "2024年5月6日7时5分"])).to_list()
    ['2024-5-6 7:00:00 PM', '2024-5-6 7:05']
    """
    if text.str.contains("[年년]").any():
        return _without_words(text)
    text = text.str.replace(_DAY + r"[T ]?(\d{2}):?(\d{2}):?(\d{2})", "${1}-${2}-${3} ${4}:${5}:${6}")
    text = text.str.replace(_DAY + r"[T ]?(\d{2}):?(\d{2})$", "${1}-${2}-${3} ${4}:${5}")
    return text.str.replace(_DAY + "$", "${1}-${2}-${3}")


def _without_words(text: pl.Series) -> pl.Series:
    """The stamps with marks in place of the words for year, month, day, hour, minute and second."""
    import polars as pl

    half = text.str.extract(_HALF_DAY, 1).replace_strict(
        {"上午": " AM", "午前": " AM", "오전": " AM", "下午": " PM", "午後": " PM", "오후": " PM"}, default=""
    )
    text = text.str.replace(_HALF_DAY, "${2}")
    for words, marks in _WORDED:
        text = text.str.replace(words, marks)
    text = text.str.replace_all(r":(\d)\b", ":0${1}")
    return pl.select(pl.concat_str(text.str.strip_chars(), half)).to_series()


def clock_text(column: pl.Series) -> pl.Series | None:
    """The times of day with marks if every number of the column reads as HHMMSS or HHMM, else None.

    A program that takes them for numbers drops the zeros in front; without any hour of two figures nothing is told.

    >>> import polars as pl
    >>> clock_text(pl.Series(["95950", "100000"])).to_list(), clock_text(pl.Series([1, 2])) is None
    (['09:59:50', '10:00:00'], True)
    """
    import polars as pl

    text = column.cast(pl.String)
    if text.null_count() or not text.str.contains(r"^\d{1,6}$").all():
        return None
    lengths = text.str.len_chars()
    if lengths.max() not in (5, 6) and not (lengths == 4).all():
        return None
    text = text.str.zfill(4 if lengths.max() == 4 else 6)
    if not text.str.contains(r"^([01]\d|2[0-3])([0-5]\d){1,2}$").all():
        return None
    return text.str.replace(r"^(\d\d)(\d\d)", "${1}:${2}:").str.strip_chars_end(":")


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
