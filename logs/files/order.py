"""The order of rows in time: rounded stamps evened out, repeats dropped, gaps and odd intervals put into words."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from stickslip.logs.errors import ReadError

__all__ = ["about_sampling", "ordered_times"]

Values = npt.NDArray[np.float64]

_GAP_STEPS = 5.0  # a step longer than this many usual ones is a gap
_SHARED_SHARE = 0.2  # share of rows that share a stamp, from which rounding, not a mistake, explains them
_FEW_SHARE = 0.01  # share of rows that may come after a later one, or correct the one before, or one row
_FEW_FROM = 20  # rows of a table in which one such row is a slip
_SHORTEST_S, _LONGEST_S = 0.05, 3600.0  # intervals [s] at which processes are logged, as a rule


def ordered_times(
    t: Values, lines: list[int], columns: list[Values], what: str = ""
) -> tuple[Values, npt.NDArray[np.intp], list[str]]:
    """Put times in order; return times that increase strictly, the rows kept, and sentences on what was done.

    A few rows that come late are put in their places; stamps that a historian has rounded are evened out. Of rows with
    one time the last is kept if they have the same values, or if few have others. Raises ReadError if more rows come
    late, or the time stands still while a value changes.

    >>> t, keep, notes = ordered_times(np.array([0.0, 1, 2, 2, 4, 5]), list(range(6)), [np.arange(6.0)])
    >>> t.tolist()
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    >>> notes
    ['1 repeated time stamp beside a double step: evened out (the stamps are rounded).']
    """
    of = f" of {what!r}" if what else ""
    order = np.arange(len(t))
    late = t < np.maximum.accumulate(t)
    sorting: list[str] = []
    few = max(1.0, _FEW_SHARE * len(t)) if len(t) >= _FEW_FROM else 0.0
    if 0 < late.sum() <= few:
        order = np.argsort(t, kind="stable")
        t, lines, columns = t[order], [lines[row] for row in order], [values[order] for values in columns]
        count = int(late.sum())
        sorting.append(
            f"{count} row{'s come' if count > 1 else ' comes'} late and {'are' if count > 1 else 'is'} put in place."
        )
    elif late.any():
        row = int(np.argmax(np.diff(t) < 0)) + 1
        raise ReadError(
            f"line {lines[row]}{of} is earlier than the line before it ({t[row]:g} s after {t[row - 1]:g} s); "
            "sort the rows by time, or export in UTC if the clock was set back"
        )
    differ = np.logical_or.reduce([~_equal(values, np.roll(values, -1)) for values in columns])
    t, notes = _evened(t, differ[:-1])
    notes = sorting + notes
    same = np.append(np.diff(t) == 0, False)  # the row after it has the same time
    changed = same & differ
    others, repeats = int(changed.sum()), int((same & ~changed).sum())
    if others > few:
        row = int(np.argmax(changed))
        raise ReadError(
            f"lines {lines[row]} and {lines[row + 1]}{of} have the same time ({t[row]:g} s) and different "
            "values; export with a finer time stamp or give interval= (--interval) if the rows are evenly spaced"
        )
    if others:
        which = "1 row has" if others == 1 else f"{others} rows have"
        row = lines[int(np.argmax(changed)) + 1]
        notes.append(f"{which} the time of the row before and other values (first in line {row}): the later is kept.")
    if repeats:
        notes.append(f"{repeats} repeated row{'s' * (repeats > 1)} dropped.")
    keep = np.flatnonzero(~same)
    return t[keep], order[keep], notes


def _equal(a: Values, b: Values) -> npt.NDArray[np.bool_]:
    return np.asarray((a == b) | (np.isnan(a) & np.isnan(b)))


def _evened(t: Values, differ: npt.NDArray[np.bool_]) -> tuple[Values, list[str]]:
    """Times with the repeats of rounded stamps moved to where their samples were taken.

    Where no two rows of one time ``differ`` in a value, those that no double step explains are one row written twice.
    """
    steps = np.diff(t)
    if not (steps == 0).any() or not (steps > 0).any():
        return t, []
    evened, moved = _beside_double_steps(t)
    if not moved or (np.diff(evened) == 0).any():
        if not differ[steps == 0].any():
            return t, []
        spread, notes = _spread(t)
        if notes or not moved:
            return spread, notes
    ending = "s beside double steps" if moved > 1 else " beside a double step"
    return evened, [f"{moved} repeated time stamp{ending}: evened out (the stamps are rounded)."]


def _beside_double_steps(t: Values) -> tuple[Values, int]:
    """A stamp that comes twice, with a step of two intervals beside it, is one of two samples put a step aside."""
    steps = np.diff(t)
    usual = float(np.median(steps[steps > 0]))
    double = np.abs(steps - 2.0 * usual) <= 0.25 * usual
    evened, moved = t.copy(), 0
    for i in np.flatnonzero(steps == 0).tolist():  # rows i and i + 1 share a stamp
        if i + 1 < len(steps) and double[i + 1]:
            evened[i + 1] = 0.5 * (t[i + 1] + t[i + 2])
            double[i + 1] = False
        elif i > 0 and double[i - 1]:
            evened[i] = 0.5 * (t[i - 1] + t[i])
            double[i - 1] = False
        else:
            continue
        moved += 1
    return evened, moved


def _spread(t: Values) -> tuple[Values, list[str]]:
    """Stamps coarser than the sampling, put on the even grid that they were rounded from, if there is one.

    The grid is the line through the stamps over the row number. It holds if many rows share a stamp and none is
    further from the line than the resolution, or if some do and none is further than rounding goes: half of it.
    """
    steps = np.diff(t)
    n, resolution = len(t), float(steps[steps > 0].min())
    shared = int((steps == 0).sum())
    if n < 10 or shared < min(5.0, _SHARED_SHARE * n):
        return t, []
    row = np.arange(n, dtype=np.float64)
    interval = float(np.polyfit(row, t, 1)[0])
    share = max(1, round(resolution / interval)) if interval > 0 else 1
    if abs(share * interval / resolution - 1.0) <= 0.02:  # a whole number of rows to a stamp
        interval = resolution / share
    grid = interval * row + np.mean(t - interval * row)
    if interval <= 0 or np.abs(t - grid).max() > (1.0 if shared >= _SHARED_SHARE * n else 0.6) * resolution:
        return t, []
    note = (
        f"Time stamps are rounded to {resolution:.4g} s and shared by several rows: "
        f"the rows are put {interval:.4g} s apart."
    )
    return t[0] + interval * row, [note]


def about_sampling(t: Values, *, guessed: bool) -> list[str]:
    """Sentences on gaps, missing rows, uneven sampling, and an interval that makes no sense for a process.

    ``guessed`` says that the unit of the time was not stated, so that a strange interval may come from it.

    >>> about_sampling(np.delete(np.arange(60.0), [7, 8, 20, *range(30, 50)]), guessed=False)
    ['1 gap in time, the longest 21 s.', '3 rows are missing in 2 places (1 s is the rule).']
    """
    steps = np.diff(t)
    if len(steps) == 0:
        return []
    usual = float(np.median(steps))
    notes = []
    if not _SHORTEST_S <= usual <= _LONGEST_S:
        doubt = f"A row every {usual:.4g} s is unusual for a process (0.1 s to 10 min is the rule)"
        remedy = "the unit of the time may be another: say it with time_unit= (--time-unit)"
        notes.append(f"{doubt}: {remedy if guessed else 'look at the time in the export'}.")
    if len(steps) < 2:
        return notes
    gaps = steps > _GAP_STEPS * usual
    if gaps.any():
        count = int(gaps.sum())
        notes.append(f"{count} gap{'s' * (count > 1)} in time, the longest {steps.max():.6g} s.")
    rest = steps[~gaps]
    rows = np.round(rest / usual)
    skipped = (rows >= 2) & (np.abs(rest - rows * usual) <= 0.1 * usual)
    if skipped.any() and np.mean(skipped) <= 0.1:
        count, places = int((rows[skipped] - 1).sum()), int(skipped.sum())
        notes.append(
            f"{count} row{'s are' if count > 1 else ' is'} missing in {places} place{'s' * (places > 1)} "
            f"({usual:.4g} s is the rule)."
        )
        rest = rest[~skipped]
    if rest.max() > 1.5 * rest.min():
        notes.append(f"Sampling is uneven: {rest.min():.4g} to {rest.max():.4g} s apart, {usual:.4g} s as a rule.")
    return notes
