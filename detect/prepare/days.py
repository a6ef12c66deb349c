"""A record of several days cut by the clock, so that each day can be judged by itself and all of them together."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
from stickslip.logs import LogError, LoopRecord

__all__ = ["CYCLES", "DAY", "MOST", "SAMPLES", "days_of", "edges_of_days", "part_of"]

DAY = 86400.0  # s
MOST = 12  # windows
SAMPLES = 300  # of a window; the shortest simulated records that the model was fitted on
CYCLES = 8.0  # periods of an oscillation in a window


def edges_of_days(record: LoopRecord, most: int = MOST, period: float = math.nan) -> tuple[list[float], int]:
    """Limits of the windows [s] and the days of each; no limits for a record of less than two days.

    A window is one day, or as many as give at most ``most`` windows, ``SAMPLES`` samples and ``CYCLES`` periods [s].

    >>> t = np.arange(0.0, 3 * DAY, 60.0)
    >>> edges_of_days(LoopRecord.from_arrays(t, pv=t, op=t))
    ([0.0, 86400.0, 172800.0, 259200.0], 1)
    """
    t0, t1 = float(record.t[0]), float(record.t[-1])
    span = t1 - t0
    if span < 1.9 * DAY:
        return [], 0
    least = max(SAMPLES * float(record.dt), CYCLES * period if math.isfinite(period) else 0.0)
    days = max(math.ceil((span / DAY + 1.0) / most), math.ceil(least / DAY))
    midnight = t0 if record.log.start is None else t0 - (_since_midnight(record) + t0) % DAY
    edges = np.arange(midnight, t1 + DAY * days, DAY * days)
    if edges[-1] < t1:
        edges = np.append(edges, edges[-1] + DAY * days)
    return edges.tolist(), days


def part_of(record: LoopRecord, start: float, end: float, *, last: bool) -> LoopRecord | None:
    """The samples from ``start`` to before ``end`` [s], of the last part with its end; None where there are none."""
    try:
        return replace(record, log=record.log.between(start, end if last else math.nextafter(end, start)))
    except LogError:
        return None


def days_of(record: LoopRecord, period: float = math.nan) -> list[LoopRecord]:
    """The days of a record that hold ``SAMPLES`` samples; none where it spans less than two.

    >>> t = np.arange(0.0, 3 * DAY, 60.0)
    >>> [len(day) for day in days_of(LoopRecord.from_arrays(t, pv=t, op=t))]
    [1440, 1440, 1440]
    """
    edges, _ = edges_of_days(record, period=period)
    parts = [part_of(record, a, b, last=b == edges[-1]) for a, b in itertools.pairwise(edges)]
    return [part for part in parts if part is not None and len(part) >= SAMPLES]


def _since_midnight(record: LoopRecord) -> float:
    start = record.log.start
    assert start is not None
    return start.hour * 3600.0 + start.minute * 60.0 + start.second + start.microsecond * 1e-6
