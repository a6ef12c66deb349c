"""The verdict over time: a record judged window by window, so that a valve that gets worse is seen to.

Windows are whole days by the clock where the record spans two days or more (several days each where there would be more
than ``WINDOWS_MAX``), else equal parts.  A part has at least ``SAMPLES_MIN`` samples and ``CYCLES_MIN`` periods of an
oscillation.  Each window is judged on its own by the calibrated answer, a long one by its last part (``stem.recent``);
sizes are shown where stiction is called.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from stickslip.detect.judge.answer import Amount, answer
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.days import CYCLES_MIN, SAMPLES_MIN, WINDOWS_MAX, edges_of_days, part_of
from stickslip.detect.words import Word
from stickslip.logs import LoopRecord
from stickslip.logs.two_digits import rounded

PARTS = 6  # of a record of less than two days
TESTED = 6  # windows: with fewer, no order is rare enough
FALSE_ALARMS_SHARE = 0.01  # of records of a constant valve, at most
ENDS = 3  # windows at either end whose sizes are compared


@dataclass(frozen=True)
class Window:
    """One window of a record.

    start, end : [s] of the record
    verdict : as in ``Verdict``; "not_applicable" also where the window holds too little
    probability : of stiction [-] or None
    limit : (S, unit) above which a stick would have shown, or None
    """

    start: float
    end: float
    samples: int
    verdict: Word
    probability: float | None
    S: Amount | None = None
    J: Amount | None = None
    limit: tuple[float, str] | None = None


@dataclass(frozen=True)
class OverTime:
    """The windows of a record, how it was divided, and what they say together.

    windows : tuple of Window, empty where the record cannot be divided
    divided : how the windows were made, or why there are none
    """

    windows: tuple[Window, ...]
    divided: str
    record: LoopRecord = field(repr=False, compare=False)

    @property
    def words(self) -> str:
        """Return the joint finding of the windows in one or two sentences; "" without windows."""
        if not self.windows:
            return ""
        judged = [w for w in self.windows if w.verdict != "not_applicable"]
        sticky = [w for w in judged if w.S is not None]
        said = f"Stiction is called in {len(sticky)} of {len(judged)} windows that could be judged."
        if len(sticky) < 2:
            return said
        first, last = sticky[: max(1, min(ENDS, len(sticky) // 2))], sticky[-max(1, min(ENDS, len(sticky) // 2)) :]
        before, after = (float(np.median([w.S.value for w in part if w.S])) for part in (first, last))
        unit = sticky[0].S.unit if sticky[0].S else ""
        moved = f"S goes from {rounded(before):g} to {rounded(after):g} {unit}"
        sizes = [w.S.value for w in sticky if w.S]
        if len(sizes) < TESTED:
            return f"{said} {moved}: whether it changes is tested from {TESTED} such windows on."
        p = trend_chance(sizes)
        width = float(np.median([w.S.high - w.S.low for w in sticky if w.S]))
        if p > FALSE_ALARMS_SHARE or abs(after - before) <= 0.5 * width:
            return f"{said} {moved}: no trend that chance and the intervals would not explain."
        return f"{said} {moved}, a trend that a constant valve shows in {p:.1%} of such records: the valve has changed."


def trend_chance(sizes: Sequence[float]) -> float:
    """The chance of so strong a trend if nothing changes, two-sided [-]: the exact test of Mann and Kendall.

    Source: Kendall, Rank Correlation Methods, 1975.  Windows are taken as independent; ``sizes`` (n,), n >= 2.

    >>> round(trend_chance([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), 4), trend_chance([2.0, 2.0, 2.0])
    (0.0028, 1.0)
    """
    from scipy.stats import kendalltau

    p = float(kendalltau(np.arange(len(sizes)), sizes).pvalue)
    return p if math.isfinite(p) else 1.0


def over_time(record: LoopRecord, *, most: int = WINDOWS_MAX) -> OverTime:
    """The record judged in windows; ``most`` is the largest number of them.

    Raises ValueError unless most >= 2.

    >>> t = np.arange(0.0, 3 * 86400.0, 60.0)
    >>> found = over_time(LoopRecord.from_arrays(t, pv=np.sin(t / 300), op=50 + np.cos(t / 300), sp=0 * t))
    >>> found.divided, len(found.windows)
    ('Windows of a day, from the start of the record.', 3)
    """
    if most < 2:
        raise ValueError(f"most = {most}, but a change over time needs at least 2 windows")
    edges, divided = _edges(record, most)
    windows = tuple(_judged(record, a, b, last=b == edges[-1]) for a, b in itertools.pairwise(edges))
    return OverTime(tuple(w for w in windows if w is not None), divided, record)


def _edges(record: LoopRecord, most: int) -> tuple[list[float], str]:
    """Limits of the windows [s], none where the record cannot be divided, and a sentence on them."""
    period = Prepared(record).period
    edges, days = edges_of_days(record, most, period)
    if edges:
        of = "a day" if days == 1 else f"{days} days"
        since = "from the start of the record" if record.log.start is None else "by the clock"
        return edges, f"Windows of {of}, {since}."
    t0, t1 = float(record.t[0]), float(record.t[-1])
    parts = min(PARTS, most, int(np.sum(record.good)) // SAMPLES_MIN)
    if math.isfinite(period):
        parts = min(parts, int((t1 - t0) / (CYCLES_MIN * period)))
    if parts < 2:
        why = f"windows need {SAMPLES_MIN} samples each, and {CYCLES_MIN:g} periods where the loop oscillates"
        return [], f"The record is too short to be divided: {why}."
    return np.linspace(t0, t1, parts + 1).tolist(), f"The record in {parts} equal parts; days say more: log longer."


def _judged(record: LoopRecord, start: float, end: float, *, last: bool) -> Window | None:
    """The answer on one window; None where no sample lies in it."""
    part = part_of(record, start, end, last=last)
    if part is None:
        return None
    held = (max(start, float(record.t[0])), min(end, float(record.t[-1])))
    if len(part) < SAMPLES_MIN:
        return Window(*held, len(part), "not_applicable", None)
    found = answer(Prepared(part))
    return Window(*held, len(part), found.word, found.probability, found.S, found.J, found.limit)
