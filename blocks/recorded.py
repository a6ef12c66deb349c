"""Signals from a table: recorded data played back, and staircases.

    previous   y = v_k                                              t_k <= t < t_(k+1)
    linear     y = v_k + (v_(k+1) - v_k) (t - t_k)/(t_(k+1) - t_k)

The ends hold: y = v_1 before t_1, y = v_n after t_n.  The table is the block's timetable (rows t_k, v_k and the slope
to the next), read with a cursor and shared by all runs.  Every t_k is an instant of the run, so playback is exact at
the knots; n knots cost at least n integration steps.
See also: sources, periodic.
"""

from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.block import Kernels
from stickslip.blocks.ports import BlockError, nearest, require
from stickslip.blocks.sources import Source
from stickslip.logs.arrays import seconds_and_start
from stickslip.logs.errors import LogError

HOLDS = ("previous", "linear")

# p = the row in force: v where it is held; t, v and the slope to the next where lines join them


def _held_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0]


def _line_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + p[2] * (t - p[0]) if t > p[0] else p[1]


def samples(
    name: str, t: ArrayLike, values: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], datetime | None]:
    """Return times [s] and values as arrays (n,), and the moment of time 0 where the times are moments.

    Raises ``BlockError`` unless both are finite numbers, n >= 1, and the times strictly increase.
    """
    try:
        seconds, clock = seconds_and_start(t)
        times, levels = np.asarray(seconds, dtype=float), np.asarray(values, dtype=float)
    except LogError as fault:
        raise BlockError(f"{name}: {fault}") from None
    except (TypeError, ValueError):
        raise BlockError(
            f"{name}: t = {t!r:.60}, values = {values!r:.60}, but both must be numbers; give an array for each"
        ) from None
    if times.ndim != 1 or times.shape != levels.shape or not times.size:
        raise BlockError(
            f"{name}: t has shape {times.shape}, values {levels.shape}, but both must be (n,) with n >= 1; "
            f"give one value per time"
        )
    bad = np.flatnonzero(~(np.isfinite(times) & np.isfinite(levels)))
    if bad.size:
        raise BlockError(
            f"{name}: {bad.size} of {times.size} samples are not finite, the first at index {bad[0]}; "
            f"drop them or fill the gaps first"
        )
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        raise BlockError(
            f"{name}: t[{back[0]}] = {times[back[0]]} is followed by {times[back[0] + 1]}, but times must "
            f"strictly increase; sort them and drop repeated ones"
        )
    return times, levels, clock


class Recorded(Source):
    """Recorded data: ``values`` at times ``t`` [s], joined by straight lines or held (``hold="previous"``).

    Moments (datetime, datetime64, what pandas makes of them) count from the first of them; ``clock`` is then the moment
    of time 0.  Durations (timedelta) become seconds.

    Raises ``BlockError`` unless t (n,) strictly increases and values (n,) are finite.

    >>> pv = Recorded("PV", [0.0, 1.0, 3.0], [5.0, 6.0, 4.0])
    >>> [float(pv.output(t, [], [])[0]) for t in (-1.0, 0.5, 1.0, 2.0, 9.0)]
    [5.0, 5.5, 6.0, 5.0, 4.0]
    """

    def __init__(
        self,
        signal: str,
        t: ArrayLike,
        values: ArrayLike,
        *,
        hold: str = "linear",
        unit: str = "",
        name: str = "",
    ) -> None:
        name = name or signal
        if hold not in HOLDS:
            raise BlockError(f"{name}: hold = {hold!r}; {nearest(str(hold), HOLDS)}")
        times, levels, self.clock = samples(name, t, values)
        held = hold == "previous"
        slopes = np.append(np.diff(levels) / np.diff(times), 0.0)
        self.kernels = Kernels(out=_held_out if held else _line_out, feeds=False, timed=not held, linear=True)
        rows = np.column_stack([times, levels] if held else [times, times, levels, slopes])
        super().__init__(signal, {}, timetable=rows, unit=unit, name=name)


class Staircase(Recorded):
    """Levels one after the other: each ``dwell`` [s] long from ``start`` [s], or from given times ``at`` [s].

    ``at`` may hold moments or durations, as the times of ``Recorded`` may.  Before the first time the first level
    holds, after the last the last.  Raises ``BlockError`` for a dwell that is not positive, or if both or neither of
    dwell and at are given.

    ``levels``: the values [unit of the signal], one after the other.

    >>> stairs = Staircase("OP", [0.4, 0.5, 0.6], dwell=100.0)
    >>> [float(stairs.output(t, [], [])[0]) for t in (0.0, 99.0, 100.0, 500.0)]
    [0.4, 0.4, 0.5, 0.6]
    """

    def __init__(
        self,
        signal: str,
        levels: Sequence[float],
        *,
        dwell: float | None = None,
        at: ArrayLike | None = None,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        times = at
        if (dwell is None) == (at is None):
            raise BlockError(f"{name or signal}: give either dwell= (one length for all levels) or at= (their times)")
        if dwell is not None:
            require(dwell > 0.0, name or signal, "dwell", dwell, "it must be positive", "give dwell= in seconds")
            times = start + np.arange(len(levels)) * dwell
        assert times is not None
        super().__init__(signal, times, levels, hold="previous", unit=unit, name=name)
