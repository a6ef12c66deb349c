"""Gaps of a record: the short ones are bridged by a straight line, the others cut the record into pieces.

A gap is what lies between two neighbouring good samples when there are bad or blank ones between them, or when
they are more than five median steps apart. It is bridged when it is at most a tenth of a period long, or a single
sample: over a tenth of a period a straight line misses a sine by at most 1 - cos(pi / 10) = 5 % of its amplitude.
"""

from bisect import bisect
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from stickslip.logs import LoopRecord

BRIDGED_SHARE = 0.1  # of a period
GAP_STEPS = 5.0  # median steps between two good samples, beyond which samples are missing; as ``LoopRecord.segments``
SINGLE_STEPS = 2.5  # median steps across one missing sample, with some room for uneven sampling
NAMED = 3  # gaps named one by one in a sentence


class Gap(NamedTuple):
    """The times [s] of the good samples on either side."""

    start: float
    end: float

    @property
    def length(self) -> float:
        """Time between the good samples on either side [s]."""
        return self.end - self.start


def gaps_in(record: LoopRecord) -> tuple[Gap, ...]:
    """Every gap of a record, in order of time.

    >>> pv = [1, 2, float("nan"), 4, 5]
    >>> gaps_in(LoopRecord.from_arrays(range(5), pv=pv, op=[1] * 5))
    (Gap(start=1.0, end=3.0),)
    """
    where = _gaps(record)[1]
    t = record.t[record.kept]
    return tuple(Gap(float(t[i]), float(t[i + 1])) for i in where)


def falls_into(gaps: Sequence[Gap], t: float) -> bool:
    """Whether the time t [s] lies in one of the gaps, which are in order of time."""
    before = bisect(gaps, t, key=lambda gap: gap.start)
    return before > 0 and t < gaps[before - 1].end


def bridgeable(record: LoopRecord, period: float) -> float:
    """The longest gap that is bridged in an oscillation of this period [s]."""
    return max(BRIDGED_SHARE * period, SINGLE_STEPS * record.dt)


def split(record: LoopRecord, bridged: float) -> list[npt.NDArray[np.int64]]:
    """Indices of the good samples, cut at every gap longer than ``bridged`` [s].

    >>> pv = [1, 2, float("nan"), 4, 5]
    >>> [part.tolist() for part in split(LoopRecord.from_arrays(range(5), pv=pv, op=[1] * 5), 2.0)]
    [[0, 1, 3, 4]]
    """
    good, where = _gaps(record)
    if len(good) == 0:
        return []
    t = record.t[record.kept]
    cuts = where[t[where + 1] - t[where] > bridged] + 1
    return np.split(good, cuts) if len(cuts) else [good]


def taken(part: npt.NDArray[np.int64]) -> slice | npt.NDArray[np.int64]:
    """What takes a part of ``split`` out of a signal: a slice where no sample between is left out.

    >>> taken(np.array([3, 4, 5])), taken(np.array([3, 5])).tolist()
    (slice(3, 6, None), [3, 5])
    """
    whole = len(part) > 0 and part[-1] - part[0] + 1 == len(part)
    return slice(int(part[0]), int(part[-1]) + 1) if whole else part


def describe(gaps: Sequence[Gap]) -> str:
    """Where the gaps are and how long, the longest by name.

    >>> describe([Gap(10.0, 30.0), Gap(50.0, 52.0)])
    '2 gaps (20 s at 10 s, 2 s at 50 s)'
    """
    longest = sorted(gaps, key=lambda gap: -gap.length)
    named = [f"{gap.length:.4g} s at {gap.start:.6g} s" for gap in longest[:NAMED]]
    more = [f"{len(gaps) - NAMED} shorter"] if len(gaps) > NAMED else []
    return f"{len(gaps)} gap{'s' * (len(gaps) != 1)} ({', '.join(named + more)})"


def _gaps(record: LoopRecord) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Indices of the good samples, and which of them a gap follows."""
    good, t = np.flatnonzero(record.good), record.t[record.kept]
    missing = np.diff(t) > GAP_STEPS * record.dt
    if len(good) < len(record):
        missing |= np.diff(good) > 1
    return good, np.flatnonzero(missing)
