"""A record of several days cut by the clock, so that each day can be judged by itself and all of them together."""

import itertools
import math
from dataclasses import replace

import numpy as np
from stickslip.logs import LogError, LoopRecord

DAY_S = 86400.0  # s
WINDOWS_MAX = 12  # windows
SAMPLES_MIN = 300  # of a window; the shortest simulated records that the model was fitted on
CYCLES_MIN = 8.0  # periods of an oscillation in a window


def edges_of_days(record: LoopRecord, most: int = WINDOWS_MAX, period: float = math.nan) -> tuple[list[float], int]:
    """Limits of the windows [s] and the days of each; no limits for a record of less than two days.

    A window is one day, or as many as give ``most`` windows at most, of ``SAMPLES_MIN`` and ``CYCLES_MIN`` periods.

    >>> t = np.arange(0.0, 3 * DAY_S, 60.0)
    >>> edges_of_days(LoopRecord.from_arrays(t, pv=t, op=t))
    ([0.0, 86400.0, 172800.0, 259200.0], 1)
    """
    t0, t1 = float(record.t[0]), float(record.t[-1])
    span = t1 - t0
    if span < 1.9 * DAY_S:
        return [], 0
    least = max(SAMPLES_MIN * float(record.dt), CYCLES_MIN * period if math.isfinite(period) else 0.0)
    days = max(math.ceil((span / DAY_S + 1.0) / most), math.ceil(least / DAY_S))
    start = record.log.start
    since = -t0 if start is None else (start - start.replace(hour=0, minute=0, second=0, microsecond=0)).total_seconds()
    midnight = t0 - (since + t0) % DAY_S
    edges = np.arange(midnight, t1 + DAY_S * days, DAY_S * days)
    if edges[-1] < t1:
        edges = np.append(edges, edges[-1] + DAY_S * days)
    return edges.tolist(), days


def part_of(record: LoopRecord, start: float, end: float, *, last: bool) -> LoopRecord | None:
    """Return the samples from ``start`` to before ``end`` [s], or None if there are none.

    The last part of a record includes its end."""
    try:
        return replace(record, log=record.log.between(start, end if last else math.nextafter(end, start)))
    except LogError:
        return None


def days_of(record: LoopRecord, period: float = math.nan) -> list[LoopRecord]:
    """The days of a record that hold ``SAMPLES_MIN`` samples; none where it spans less than two.

    >>> t = np.arange(0.0, 3 * DAY_S, 60.0)
    >>> [len(day) for day in days_of(LoopRecord.from_arrays(t, pv=t, op=t))]
    [1440, 1440, 1440]
    """
    edges, _ = edges_of_days(record, period=period)
    parts = [part_of(record, a, b, last=b == edges[-1]) for a, b in itertools.pairwise(edges)]
    return [part for part in parts if part is not None and len(part) >= SAMPLES_MIN]
