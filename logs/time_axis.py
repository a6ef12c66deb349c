"""The time axis of a picture: clock time where it is known, else time since the start, in the unit that suits."""

from __future__ import annotations

from datetime import timedelta
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from stickslip.logs.arrays import Values
    from stickslip.logs.log import Log

__all__ = ["TimeAxis", "time_unit"]

DAY_S = 86400.0  # s


def time_unit(duration: float) -> tuple[float, str]:
    """Seconds in the unit that suits a record of ``duration`` [s], and its name.

    >>> time_unit(90.0), time_unit(7200.0), time_unit(3e5)
    ((1.0, 's'), (60.0, 'min'), (3600.0, 'h'))
    """
    if duration < 600:
        return 1.0, "s"
    if duration < 6 * 3600:
        return 60.0, "min"
    return (3600.0, "h") if duration < 10 * 86400 else (86400.0, "d")


class TimeAxis:
    """Where the times of a log stand on an axis.

    ``log`` gives the start on the clock, if it is known; ``duration`` [s] is how much of it is drawn, by default all.

    >>> from datetime import datetime
    >>> from stickslip.logs import Log
    >>> axis = TimeAxis(Log(t=[0, 60], signals={"OP": [50, 51]}, start=datetime(2024, 5, 6)))
    >>> axis.clock, round(float(np.ptp(axis.at(np.array([0.0, 60.0])))) * 86400.0, 3)
    (True, 60.0)
    """

    def __init__(self, log: Log, duration: float | None = None) -> None:
        self.start = log.start
        self.scale, self.unit = time_unit(log.duration if duration is None else duration)
        self._zero = 0.0
        if self.start is not None:
            from matplotlib.dates import date2num

            self._zero = float(date2num(self.start.replace(tzinfo=None)))  # type: ignore[no-untyped-call]

    @property
    def clock(self) -> bool:
        """Whether the axis shows clock time."""
        return self.start is not None

    def at(self, t: Values) -> Values:
        """Places on the axis of times t (n,) [s] of the log."""
        return self._zero + t / DAY_S if self.clock else t / self.scale

    def finish(self, ax: Axes, t0: float, t1: float) -> None:
        """Set limits, ticks and name of the axis of ``ax`` for times from t0 to t1 [s]."""
        low, high = self.at(np.array([t0, t1])).tolist()
        if not high > low:
            half = 0.5 / DAY_S if self.clock else 0.5
            low, high = low - half, high + half
        ax.set_xlim(low, high)
        if self.start is None:
            ax.set_xlabel(f"time [{self.unit}]")
            return
        from matplotlib.dates import AutoDateLocator, ConciseDateFormatter

        locator = AutoDateLocator(minticks=4, maxticks=9)  # type: ignore[no-untyped-call]
        ax.xaxis.set_major_locator(locator)
        shown = ConciseDateFormatter(locator, show_offset=False)  # type: ignore[no-untyped-call]
        ax.xaxis.set_major_formatter(shown)
        ax.set_xlabel(f"clock time, from {self.start + timedelta(seconds=t0):%Y-%m-%d %H:%M:%S}")
