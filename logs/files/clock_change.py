"""The two hours a year at which a clock of local time is set: one comes twice in autumn, one is left out in spring."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime, timedelta

import numpy as np
import numpy.typing as npt

__all__ = ["repaired_clock_change", "repaired_in_tags"]

Values = npt.NDArray[np.float64]

_HOUR_S = 3600.0
_USUAL_STEPS = 5.0  # a step over the change, without its hour, is at most so many usual ones
# Clocks are set ahead on a Sunday of these months, north and south, at these full hours of local time.
_SUNDAY, _MONTHS, _AT = 6, (3, 4, 9, 10), (0, 1, 2, 3)


def repaired_clock_change(t: Values, start: datetime | None = None) -> tuple[Values, str | None]:
    """Undo a change of the clock in a file of local time.

    In autumn: a step back of exactly one hour is undone if it is the single step back and an hour later it becomes an
    ordinary step, at most five times the median one. In spring: the hour that is left out is taken away if it is a full
    hour of a Sunday at which clocks are set, with rows right before and right after it. ``start`` is the clock time of
    second 0; without one, or with one in UTC, nothing is left out. Returns the times and the sentence to note, None if
    nothing was done.

    >>> t, note = repaired_clock_change(np.array([0.0, 10.0, 20.0, -3570.0, -3560.0]))
    >>> t.tolist()
    [0.0, 10.0, 20.0, 30.0, 40.0]
    >>> spring = datetime(2024, 3, 31, 1, 59, 40)
    >>> repaired_clock_change(np.array([0.0, 10.0, 3620.0, 3630.0]), spring)[0].tolist()
    [0.0, 10.0, 20.0, 30.0]
    """
    steps = np.diff(t)
    if not (steps > 0).any():
        return t, None
    usual = float(np.median(steps[steps > 0]))
    back = np.flatnonzero(steps < 0)
    if len(back) == 1 and 0 < steps[back[0]] + _HOUR_S <= _USUAL_STEPS * usual:
        i = int(back[0])
        return np.where(np.arange(len(t)) > i, t + _HOUR_S, t), (
            f"The clock steps back one hour after {t[i]:g} s (end of summer time): later times are one hour added."
        )
    if start is None or start.tzinfo is not None:
        return t, None
    least = max(_HOUR_S, usual + 0.5 * _HOUR_S)  # rows two hours or a day apart step that far on any Sunday
    for i in np.flatnonzero((steps > least) & (steps <= _HOUR_S + _USUAL_STEPS * usual)).tolist():
        if _is_left_out(start, float(t[i]), float(t[i + 1])):
            return np.where(t > t[i], t - _HOUR_S, t), (
                f"The clock steps ahead one hour after {t[i]:g} s (start of summer time): "
                "later times are one hour less."
            )
    return t, None


def _is_left_out(start: datetime, before: float, after: float) -> bool:
    """Whether a clock is set between the two times: the first full hour after one is over at the other."""
    behind = start + timedelta(seconds=before)
    change = behind.replace(minute=0, second=0, microsecond=0) + timedelta(hours=1)
    over = start + timedelta(seconds=after) >= change + timedelta(hours=1)
    return over and change.weekday() == _SUNDAY and change.month in _MONTHS and change.hour in _AT


def repaired_in_tags(
    t: Values, start: datetime | None, rows_of: Mapping[str, npt.NDArray[np.intp]]
) -> tuple[Values, str | None]:
    """The same for a long table: all rows in one order, or the rows of one tag after those of another.

    A tag that does not show the hour that comes twice has its reports after that hour put one hour later with the rest.
    """
    whole, note = repaired_clock_change(t)
    if note is not None:
        return whole, note
    repaired, ends = t.copy(), []
    for rows in rows_of.values():
        own, found = repaired_clock_change(t[rows])
        if found is not None:
            repaired[rows], note = own, note or found
            ends.append(float(t[rows][own == t[rows]].max()))
    if ends:
        return np.where((t > max(ends)) & (repaired == t), t + _HOUR_S, repaired), note
    clock = np.unique(t)
    spring, note = repaired_clock_change(clock, start)
    return spring[np.searchsorted(clock, t)], note
