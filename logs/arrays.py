"""The arrays that a log is made of, checked once: time, values, spans and quality."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np
import numpy.typing as npt
from stickslip.logs.errors import LogError

__all__ = [
    "Indices", "Mask", "Values", "check_time", "checked_mask", "checked_span", "frozen_array", "seconds_and_start",
]  # fmt: skip

Values = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]


def frozen_array(values: npt.ArrayLike, what: str) -> Values:
    """Return values as a read-only array, shape (n,), copied unless they are one; raise ``LogError`` for others."""
    if isinstance(values, np.ndarray) and values.dtype == np.float64 and not values.flags.writeable:
        array = values
    else:
        try:
            array = np.array(values, dtype=np.float64)
        except (TypeError, ValueError) as fault:
            raise LogError(f"{what} is not an array of numbers ({fault}); convert it first") from None
        array.flags.writeable = False
    if array.ndim != 1:
        raise LogError(f"{what} has shape {array.shape}; it must have one dimension, one value a sample")
    return array


def seconds_and_start(t: npt.ArrayLike) -> tuple[npt.ArrayLike, datetime | None]:
    """Seconds from the first sample, and its wall-clock time, if ``t`` holds moments; else ``t`` as it is and None.

    Moments are datetime64, datetime objects and what pandas and polars make of them; stamps with a time zone give a
    start in UTC. Durations (timedelta64) become seconds.

    Raises LogError for a moment that is not a time (NaT).

    >>> t, start = seconds_and_start(np.array(["2024-06-13T21:55:00", "2024-06-13T21:55:10"], dtype="datetime64[ns]"))
    >>> t.tolist(), start.isoformat()
    ([0.0, 10.0], '2024-06-13T21:55:00')
    """
    array = np.asarray(t)
    zone = None
    if array.dtype == object and array.ndim == 1 and len(array):
        first = array[0]
        if isinstance(first, timedelta):
            array = array.astype("m8[us]")
        elif isinstance(first, datetime):
            if first.tzinfo is not None:
                array, zone = np.array([moment.astimezone(UTC).replace(tzinfo=None) for moment in array]), UTC
            array = array.astype("M8[us]")
    if array.dtype.kind not in "Mm" or array.ndim != 1 or len(array) == 0:
        return t, None
    gone = np.isnat(array)
    if gone.any():
        raise LogError(f"t[{int(np.argmax(gone))}] is no time (NaT); drop the rows without a time")
    if array.dtype.kind == "m":
        return array / np.timedelta64(1, "s"), None
    start: datetime = array[0].astype("M8[us]").item().replace(tzinfo=zone)
    return (array - array[0]) / np.timedelta64(1, "s"), start


def check_time(t: Values) -> None:
    """Raise ``LogError`` unless the times [s] are finite and strictly increase, n >= 1."""
    if len(t) == 0:
        raise LogError("time is empty; a log needs at least one sample")
    if np.isfinite(t[0]) and np.isfinite(t[-1]) and (t[1:] > t[:-1]).all():  # so all between are finite too
        return
    finite = np.isfinite(t)
    if not finite.all():
        bad = int(np.argmin(finite))
        raise LogError(f"time must be finite: t[{bad}] = {t[bad]}; drop the rows without a time")
    falls = np.flatnonzero(np.diff(t) <= 0)
    if len(falls):
        i = int(falls[0]) + 1
        raise LogError(
            f"time must increase strictly: t[{i}] = {t[i]} s follows t[{i - 1}] = {t[i - 1]} s; "
            "sort the rows and drop repeats first"
        )


def checked_span(name: str, span: tuple[float, float]) -> tuple[float, float]:
    """Return a span as (low, high); raise ``LogError`` unless both are finite and low < high."""
    try:
        low, high = (float(limit) for limit in span)
    except (TypeError, ValueError):
        raise LogError(f"span of {name!r} = {span!r} is not a pair of numbers; give (low, high) in its unit") from None
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise LogError(f"span of {name!r} = ({low:g}, {high:g}) is empty; give finite low < high in its unit")
    return low, high


def checked_mask(name: str, quality: npt.ArrayLike, n: int) -> Mask:
    """Return quality as a read-only mask, shape (n,); raise ``LogError`` for other types and shapes."""
    mask = np.array(quality)
    if mask.dtype != np.bool_:
        raise LogError(f"quality of {name!r} has type {mask.dtype}; give True for good and False for bad")
    if mask.shape != (n,):
        raise LogError(f"quality of {name!r} has shape {mask.shape}; it must be ({n},) as time is")
    mask.flags.writeable = False
    return mask
