"""Times written as numbers: which unit they are in, where they count from, and what is doubtful about it."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from stickslip.logs.errors import ReadError
from stickslip.logs.files.time_names import TIME_UNITS, unit_named

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Times", "stated_unit", "times_from_numbers"]


@dataclass(frozen=True)
class Times:
    """Seconds of every row, the wall-clock time of second 0 if the file tells it, and whether the unit is sure."""

    t: npt.NDArray[np.float64]
    start: datetime | None = None
    notes: tuple[str, ...] = ()
    guessed: bool = False  # numbers without a unit: a strange interval may be a wrong guess


_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0}
_WORDS = {
    "s": "seconds", "ms": "milliseconds", "us": "microseconds", "ns": "nanoseconds", "min": "minutes", "h": "hours",
    "d": "days",
}  # fmt: skip


@dataclass(frozen=True)
class _Clock:
    """A count since a date: its step [s], where it starts, and the counts of the years 1995 to 2060."""

    name: str
    step: float
    origin: datetime
    decimals: int  # of the seconds that the count can tell

    def holds(self, low: float, high: float) -> bool:
        first, last = (
            (datetime(year, 1, 1) - self.origin.replace(tzinfo=None)) / timedelta(seconds=1) / self.step
            for year in (1995, 2060)
        )
        return first < low and high < last


_UNIX = datetime(1970, 1, 1, tzinfo=UTC)
_COUNTS = {
    "s": _Clock("seconds since 1970 (UTC)", 1.0, _UNIX, 6),
    "ms": _Clock("milliseconds since 1970 (UTC)", 1e-3, _UNIX, 6),
    "us": _Clock("microseconds since 1970 (UTC)", 1e-6, _UNIX, 6),
    "ns": _Clock("nanoseconds since 1970 (UTC)", 1e-9, _UNIX, 6),
    "filetime": _Clock("FILETIME, 100 ns since 1601 (UTC)", 1e-7, datetime(1601, 1, 1, tzinfo=UTC), 6),
    "ticks": _Clock("ticks of 100 ns since the year 1", 1e-7, datetime(1, 1, 1), 6),
    "labview": _Clock("seconds since 1904 (UTC), as LabVIEW counts", 1.0, datetime(1904, 1, 1, tzinfo=UTC), 6),
    # Days in double precision tell 1e-5 s at best; milliseconds are what the programs mean.
    "excel": _Clock("spreadsheet day serials", 86400.0, datetime(1899, 12, 30), 3),
    "datenum": _Clock("MATLAB datenum, days since the year 0", 86400.0, datetime(1, 1, 1), 3),
}
_DATENUM_OF_YEAR_1 = 367.0  # datenum(1, 1, 1)
_LONG_S = (600, 720, 900, 1200, 1800, 3600, 7200, 14400, 21600, 28800, 43200, 86400)  # usual intervals [s] of reports
_USUAL_S = (0.1, 0.2, 0.25, 0.5, 1, 2, 4, 5, 10, 15, 20, 30, 60)  # usual intervals [s] of a historian or a logger


def stated_unit(word: str) -> str:
    """The unit that a caller names, one of ``TIME_UNITS``.

    Raises ReadError for others.

    >>> stated_unit("milliseconds")
    'ms'
    """
    unit = unit_named(word)
    if unit is None:
        raise ReadError(f"time unit {word!r} is not known; give one of {', '.join(TIME_UNITS)}")
    return unit


def times_from_numbers(numbers: pl.Series, lines: list[int], unit: str = "", asked: str | None = None) -> Times:
    """Return the numbers of a time column in seconds.

    Parameters: ``numbers`` (polars.Series of Int64 or Float64); ``lines`` (list of int) Line of each row, for messages;
    ``unit`` (str) Unit that the file states for the column; "" when it states none; ``asked`` (str, optional) One of
    ``TIME_UNITS``, given by the caller; it overrides everything else.

    Without a unit, counts since a date are recognised by their size, and other units by the interval between rows.
    An interval that makes no sense in seconds, but is usual in another unit, is read in that unit.

    Raises ReadError for a time that is not finite, or that is not what the caller says it is.

    >>> import polars as pl
    >>> times = times_from_numbers(pl.Series([0, 1000, 2000]), [2, 3, 4])
    >>> times.t.tolist(), times.notes[0]
    ([0.0, 1.0, 2.0], 'Time goes up by 1000 a row and has no unit: it is read as milliseconds, 1 s apart; ...')
    """
    t = numbers.to_numpy()
    if t.dtype.kind == "f" and not np.isfinite(t).all():
        row = int(np.argmin(np.isfinite(t)))
        raise ReadError(f"line {lines[row]} has a time that is not finite ({t[row]}); delete the row")
    low, high = float(t.min()), float(t.max())
    stated = unit_named(unit) if unit.strip() else None
    chosen = asked or stated
    for name, count in _COUNTS.items():
        if chosen in (None, name) and _is_count(name, t, low, high, sure=chosen is not None):
            return _counted(name, count, t)
    if chosen is not None:
        if chosen not in _SECONDS:
            raise ReadError(
                f"the times {low:.15g} to {high:.15g} are not {_COUNTS[chosen].name}, of the years 1995 to 2060; "
                "name the unit they are in with time_unit= (--time-unit)"
            )
        notes = () if chosen == "s" and not asked else (f"Time is read in {_WORDS[chosen]} and given in seconds.",)
        return Times(t.astype(np.float64) * _SECONDS[chosen], notes=notes)
    return _without_unit(t.astype(np.float64), unit.strip())


def _is_count(name: str, t: npt.NDArray[np.generic], low: float, high: float, *, sure: bool) -> bool:
    if name == "datenum":
        low, high = low - _DATENUM_OF_YEAR_1, high - _DATENUM_OF_YEAR_1
    if not _COUNTS[name].holds(low, high):
        return False
    # Days go up by less than 0.02 (half an hour) a row; seconds in that range would not.
    return sure or _COUNTS[name].step < 86400.0 or 0 < _interval(t.astype(np.float64)) < 0.02


def _counted(name: str, count: _Clock, t: npt.NDArray[np.generic]) -> Times:
    # Whole numbers are subtracted as such: a double holds a FILETIME to 2 us and nanoseconds to 0.3 us only.
    passed = np.round((t - t[0]).astype(np.float64) * count.step, count.decimals)
    first = float(t[0]) - (_DATENUM_OF_YEAR_1 if name == "datenum" else 0.0)
    if np.issubdtype(t.dtype, np.integer) and count.step < 1:
        per_second = round(1.0 / count.step)
        whole, part = divmod(int(t[0]), per_second)
        since = timedelta(seconds=whole, microseconds=part * 1_000_000 // per_second)
    else:
        since = timedelta(seconds=first * count.step)
    return Times(passed, count.origin + since, (f"Time is read as {count.name}.",))


def _without_unit(t: npt.NDArray[np.float64], unit: str) -> Times:
    step = _interval(t)
    chosen = _unit_by_interval(t, step)
    if unit:
        note = f"The unit {unit!r} of the time is not known: it is read as seconds; give time_unit= (--time-unit)."
        return Times(t, notes=(note,), guessed=True)
    if chosen == "s":
        said = f", {step:.6g} s apart" if step > 0 else ""
        return Times(t, notes=(f"Time has no unit: it is read as seconds{said}.",), guessed=True)
    scaled = t * _SECONDS[chosen]
    note = (
        f"Time goes up by {step:.4g} a row and has no unit: it is read as {_WORDS[chosen]}, "
        f"{_interval(scaled):.4g} s apart; if that is wrong, give time_unit= (--time-unit)."
    )
    return Times(scaled, notes=(note,), guessed=True)


def _interval(t: npt.NDArray[np.float64]) -> float:
    """The usual step, 0.0 for a single row; times may fall or repeat."""
    return float(np.median(np.abs(np.diff(t)))) if len(t) > 1 else 0.0


def _unit_by_interval(t: npt.NDArray[np.float64], step: float) -> str:
    """The unit in which the interval is a usual one, "s" unless it makes no sense in seconds."""
    if step <= 0:
        return "s"
    if step >= 1000 and not _near(step, _LONG_S, 0.02):
        fine = next((unit for unit in ("ms", "us", "ns") if _near(step * _SECONDS[unit], _USUAL_S, 0.02)), None)
        return fine or "s"
    # Minutes, hours and days have fractions that no clock of seconds has; a file that rounds them tells
    # the interval by its whole length only.
    mean = abs(float(t[-1] - t[0])) / (len(t) - 1)
    if step >= 0.5 or _near(step, (*_USUAL_S, 0.01, 0.02, 0.04, 0.05, 0.001, 0.002, 0.005), 1e-3):
        return "s"
    for unit in ("min", "h", "d"):
        usual = [seconds for seconds in _USUAL_S if seconds >= 1]
        exact = _near(step * _SECONDS[unit], usual, 1e-4) or _near(mean * _SECONDS[unit], usual, 1e-3)
        # 1/60 is one second in minutes and one minute in hours: that is for the user to say.
        if exact and not _near(step, (1 / 60,), 0.01):
            return unit
    return "s"


def _near(value: float, marks: object, share: float) -> bool:
    return bool(np.any(np.abs(value / np.asarray(marks, dtype=float) - 1.0) <= share))
