"""Time columns: numbers, date-times and the clock stamps of historians."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

import numpy as np
from stickslip.logs.errors import ReadError
from stickslip.logs.files.calendar_numbers import calendar_text, with_marks
from stickslip.logs.files.numeric_time import Times, stated_unit, times_from_numbers

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Times", "parse_times"]

_CLOCK = (
    r"(?:[T ,]+(?P<h>\d{1,2}):(?P<m>\d{2})(?::(?P<s>\d{2})(?:[.,:](?P<f>\d{1,9}))?)?"
    r"\s*(?P<ap>[AaPp])?(?:\.?\s*[Mm]\.?)?)?"
    # Names of zones, such as CEST, are passed over: the stamps are then local time.
    r"\s*(?:(?P<z>Z|z|UTC|GMT|[+-]\d{2}(?::?\d{2})?)|ME?S?Z|[A-Z]{1,3}[DS]?T)?$"
)
_DATES = {
    "year-month-day": r"^(?P<Y>\d{4})[-/.](?P<M>\d{1,2})[-/.](?P<D>\d{1,2})",
    "day-month name-year": r"^(?P<D>\d{1,2})[- /](?P<M>\p{L}{3})\p{L}*\.?[- /,]+(?P<Y>\d{4}|\d{2})",
    "month name day, year": r"^(?P<M>\p{L}{3})\p{L}*\.? +(?P<D>\d{1,2}),? +(?P<Y>\d{4})",
    "day.month.year": r"^(?P<D>\d{1,2})\.(?P<M>\d{1,2})\.(?P<Y>\d{4}|\d{2})",
    "month/day/year": r"^(?P<M>\d{1,2})[-/](?P<D>\d{1,2})[-/](?P<Y>\d{4}|\d{2})",
    "day/month/year": r"^(?P<D>\d{1,2})[-/](?P<M>\d{1,2})[-/](?P<Y>\d{4}|\d{2})",
}
# English first, then German, Nordic, Dutch, French, Spanish, Italian and Portuguese, where they differ. French "jui"
# may be June or July: not decided.
_MONTH_WORDS = (
    "jan ene gen", "feb fév fev", "mar mär mrz mrt maa", "apr avr abr", "may mai maj mei mag", "jun giu",
    "jul lug", "aug aoû aou ago", "sep set", "oct okt ott out", "nov", "dec dez des déc dic",
)  # fmt: skip
_AT_ONCE = 100_000  # stamps that are cut into parts at once: these take 400 bytes each
_MONTHS = {name: i for i, names in enumerate(_MONTH_WORDS, start=1) for name in names.split()}
_HOUR_S = 3600.0


def parse_times(
    column: pl.Series,
    lines: list[int],
    unit: str = "",
    decimal: str = ".",
    time_format: str | None = None,
    time_unit: str | None = None,
) -> Times:
    """The times in ``column``; order and repeats are not looked at here.

    Parameters: ``column`` (polars.Series) Text, numbers or date-times, one a row; ``lines`` (list of int) Line of the
    file of each row, for messages; ``unit`` (str) Unit that the file states for a column of numbers, "" for none (see
    ``stickslip.logs.files.numeric_time``); ``decimal`` (str) Decimal mark of numbers; ``time_format`` (str, optional)
    strptime format of the stamps, for what is not recognised by itself; ``time_unit`` (str, optional) Unit of a column
    of numbers, said by the caller.

    Raises ReadError if a row has no time, or one that cannot be read.

    >>> import polars as pl
    >>> times = parse_times(pl.Series(["13-Jun-24 21:55:00", "13-Jun-24 21:55:10"]), [2, 3])
    >>> times.t.tolist(), times.start
    ([0.0, 10.0], datetime.datetime(2024, 6, 13, 21, 55))
    """
    import polars as pl

    if column.dtype.is_temporal():
        return _from_datetimes(column, lines)
    if not unit and time_unit is None and time_format is None:
        calendar = calendar_text(column)
        if calendar is not None:
            times = _from_stamps(calendar, lines)
            return Times(times.t, times.start, (f"Times such as {column[0]} are read as {calendar[0]}.",))
    if column.dtype.is_numeric():
        return _from_numbers(column, lines, unit, time_unit)
    text = column.cast(pl.String)
    missing = text.is_null() | (text.str.strip_chars() == "")
    if missing.any():
        raise ReadError(f"line {lines[_first(missing)]} has no time; delete the row or fill in the time")
    if time_format is not None:
        return _with_format(text, lines, time_format)
    plain = text.str.replace(",", ".", literal=True) if decimal == "," else text
    numbers = plain.cast(pl.Float64, strict=False)
    if numbers.null_count() == 0:
        whole = plain.cast(pl.Int64, strict=False)
        return _from_numbers(whole if whole.null_count() == 0 else numbers, lines, unit, time_unit)
    if time_unit is not None:
        row = _first(numbers.is_null())
        raise ReadError(
            f"line {lines[row]} has the time {text[row]!r}, which is not a number in {time_unit}; "
            "leave time_unit (--time-unit) out for clock times"
        )
    if numbers.null_count() < len(numbers) / 2:
        row = _first(numbers.is_null())
        raise ReadError(f"line {lines[row]} has the time {text[row]!r}, which is not a number; mend the row")
    if text.str.contains(r"^\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?$").all():
        return _time_of_day(text)
    return _from_stamps(text, lines)


def _first(mask: pl.Series) -> int:
    found = mask.fill_null(False).arg_max()
    return 0 if found is None else found


def _from_numbers(column: pl.Series, lines: list[int], unit: str, time_unit: str | None) -> Times:
    import polars as pl

    if column.null_count():
        raise ReadError(f"line {lines[_first(column.is_null())]} has no time; delete the row or fill in the time")
    whole = column.cast(pl.Int64, strict=False) if column.dtype.is_integer() else None
    numbers = whole if whole is not None and whole.null_count() == 0 else column.cast(pl.Float64)
    return times_from_numbers(numbers, lines, unit, None if time_unit is None else stated_unit(time_unit))


def _from_datetimes(column: pl.Series, lines: list[int]) -> Times:
    import polars as pl

    if column.null_count():
        raise ReadError(f"line {lines[_first(column.is_null())]} has no time; delete the row")
    if column.dtype == pl.Duration:
        return Times(column.dt.total_microseconds().to_numpy() / 1e6)
    if column.dtype == pl.Time:
        return Times(column.cast(pl.Int64).to_numpy() / 1e9)
    zone = getattr(column.dtype, "time_zone", None)
    moments = column.cast(pl.Datetime("us")) if zone is None else column.dt.convert_time_zone("UTC")
    micros = moments.dt.epoch("us").to_numpy()
    try:
        start = datetime(1970, 1, 1, tzinfo=UTC if zone else None) + timedelta(microseconds=int(micros[0]))
    except OverflowError:
        raise ReadError(
            f"line {lines[0]} has a time of no calendar ({int(micros[0]):.3g} us since 1970); mend the time column, "
            "years 1 to 9999 are read"
        ) from None
    return Times((micros - micros[0]) / 1e6, start)


def _with_format(text: pl.Series, lines: list[int], time_format: str) -> Times:
    import polars as pl

    try:
        moments = text.str.strptime(pl.Datetime("us"), time_format, strict=False)
    except pl.exceptions.PolarsError as fault:
        raise ReadError(f"time format {time_format!r} is not valid ({fault}); see strptime") from None
    if moments.null_count():
        row = _first(moments.is_null())
        raise ReadError(
            f"line {lines[row]} has the time {text[row]!r}, which does not fit the format {time_format!r}; "
            "give the format of the file"
        )
    return _from_datetimes(moments, lines)


def _time_of_day(text: pl.Series) -> Times:
    parts = text.str.replace(",", ".", literal=True).str.split(":").to_list()
    t = np.array([sum(float(part) * _HOUR_S / 60.0**i for i, part in enumerate(row)) for row in parts])
    wraps = np.diff(t) < -43200.0
    short = text[0].count(":") == 1
    notes = [f"Time is a time of day without a date{', read as hours:minutes' * short}."]
    if wraps.any():
        t[1:] += 86400.0 * np.cumsum(wraps)
        notes.append(f"Midnight is passed {int(wraps.sum())} time{'s' * (int(wraps.sum()) > 1)}.")
    return Times(t, notes=tuple(notes))


def _from_stamps(text: pl.Series, lines: list[int]) -> Times:
    text = with_marks(text)
    fits: dict[str, pl.Series] = {}
    for name, pattern in _DATES.items():
        if text.str.contains(pattern + _CLOCK).all():
            moments = _moments(text, pattern + _CLOCK)
            if moments.null_count() == 0:
                fits[name] = moments
    if not fits:
        row = _unreadable_row(text)
        raise ReadError(
            f"line {lines[row]} has the time {text[row]!r}, which is not read; give time_format "
            "(--time-format), for example '%d/%m/%y %H:%M:%S'"
        )
    notes: tuple[str, ...] = ()

    # The order of day and month: what runs forward wins, then what takes less time, then month/day.
    def unlikely(name: str) -> tuple[bool, int]:
        steps = fits[name].dt.epoch("us")
        runs = steps.is_sorted() or steps.is_sorted(descending=True)  # some systems write the newest row first
        return not runs, int(steps.max()) - int(steps.min())  # type: ignore[arg-type]

    chosen = min(fits, key=unlikely)
    if "month/day/year" in fits and "day/month/year" in fits:
        notes = (f"Dates such as {text[0]!r} are read as {chosen}; give time_format if that is wrong.",)
    times = _from_datetimes(fits[chosen], lines)
    zoned = bool(text.str.contains(r"(?:Z|z|UTC|GMT|:\d{2}(?:\.\d+)?\s*[+-]\d{2}(?::?\d{2})?)$")[0])
    start = times.start.replace(tzinfo=UTC) if zoned and times.start else times.start
    return Times(times.t, start, notes)


def _unreadable_row(text: pl.Series) -> int:
    """The first row that does not fit the pattern most rows fit."""
    counts = {name: text.str.contains(pattern + _CLOCK) for name, pattern in _DATES.items()}
    best = max(counts.values(), key=lambda fit: int(fit.sum()))
    return _first(~best)


def _moments(text: pl.Series, pattern: str) -> pl.Series:
    """Date-times by the pattern, in UTC where the stamp tells its offset; null where they do not exist."""
    import polars as pl

    first = range(0, max(len(text), 1), _AT_ONCE)
    return pl.concat([_moments_of(text.slice(i, _AT_ONCE), pattern) for i in first], rechunk=True)


def _moments_of(text: pl.Series, pattern: str) -> pl.Series:
    """Date-times of a part of a column."""
    import polars as pl

    parts = text.str.extract_groups(pattern).struct.unnest()
    whole = {key: parts[key].cast(pl.Int32, strict=False).fill_null(0) for key in ("Y", "D", "h", "m", "s")}
    month = parts["M"].str.to_lowercase()
    number = month.cast(pl.Int32, strict=False)
    if number.null_count():
        number = month.replace_strict(_MONTHS, default=None, return_dtype=pl.Int32)
    century = pl.when(pl.col("Y") < 100).then(pl.when(pl.col("Y") < 70).then(2000).otherwise(1900)).otherwise(0)
    afternoon = parts["ap"].str.to_lowercase().fill_null("")
    offset = parts["z"].fill_null("").str.extract_groups(r"([+-])(\d{2}):?(\d{2})?").struct.unnest()
    frame = pl.DataFrame(whole | {"M": number, "ap": afternoon}).with_columns(
        us=parts["f"].fill_null("").str.pad_end(6, "0").str.slice(0, 6).cast(pl.Int32, strict=False).fill_null(0),
        minutes=(
            (offset[:, 1].cast(pl.Int64, strict=False) * 60 + offset[:, 2].cast(pl.Int64, strict=False).fill_null(0))
            * (offset[:, 0] == "-").replace_strict({True: -1, False: 1}, default=0, return_dtype=pl.Int64)
        ).fill_null(0),
    )
    hour = (
        pl.when(pl.col("ap") == "p").then(pl.col("h") % 12 + 12)
        .when(pl.col("ap") == "a").then(pl.col("h") % 12)
        .otherwise(pl.col("h"))
    )  # fmt: skip
    frame = frame.with_columns(Y=pl.col("Y") + century, h=hour).with_columns(
        # 24:00 and months of 13 do not exist: null, so that another order of the date is tried.
        valid=(pl.col("h") < 24)
        & (pl.col("m") < 60)
        & (pl.col("s") < 60)
        & pl.col("M").is_between(1, 12)
        & pl.col("D").is_between(1, 31),
    )
    text_date = frame.select(
        pl.format("{}-{}-{}", "Y", pl.col("M"), pl.col("D")).str.strptime(pl.Date, "%Y-%m-%d", strict=False)
    ).to_series()
    seconds = frame["h"].cast(pl.Int64) * 3600 + frame["m"] * 60 + frame["s"] - frame["minutes"] * 60
    micros = seconds * 1_000_000 + frame["us"]
    moments = text_date.cast(pl.Datetime("us")).dt.epoch("us") + micros
    return frame.select(pl.when(pl.col("valid")).then(moments).otherwise(None)).to_series().cast(pl.Datetime("us"))
