"""One loop of a scan: screened, judged where it oscillates or sticks, and put into one row of plain values."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import numpy as np

from logs import LoopRecord
from scan.sources import Job

__all__ = ["SECONDS_MAX", "judged", "row_of"]

SECONDS_MAX = 60  # s for one loop; the full set of methods takes half a second
JOB_ROWS = 10_000  # rows that one job may give: row j of job i has the order i * JOB_ROWS + j
REASON_MAX = 2_000  # characters

Row = dict[str, Any]


def judged(job: Job, number: int) -> list[Row]:
    """The rows of a job; whatever goes wrong with one loop stands in its row and stops no other."""
    rows: list[Row] = []
    read = job.read()
    while True:
        name = ""
        try:
            with _within(SECONDS_MAX):
                name, record = next(read, ("", None))
                if record is None:
                    return rows
                row = {"loop": name, "error": record} if isinstance(record, str) else row_of(record)
        except Exception as fault:  # a scan overnight must not end at one loop
            row = {"loop": name or f"job {number}", "error": f"{type(fault).__name__}: {fault}"[:REASON_MAX]}
        rows.append(row | {"order": number * JOB_ROWS + len(rows)})


def row_of(record: LoopRecord) -> Row:
    """What a scan says of one record."""
    from detect import diagnose
    from detect.prepare.prepared import prepared

    loop = prepared(record)
    answer = diagnose(loop)
    t = record.t
    return {
        "loop": record.name,
        "verdict": answer.verdict,
        "probability": answer.probability,
        "period_s": loop.period if loop.gate.oscillating else None,
        "amplitude": _amplitude(record.pv),
        "health": ", ".join(fact.code for fact in loop.present),
        "reason": answer.reason[:REASON_MAX],
        "samples": len(t),
        "interval_s": float(record.dt),
        "hours": float(t[-1] - t[0]) / 3600.0,
    }


def _amplitude(pv: Any) -> float | None:
    """Half of the width that holds 90 % of PV."""
    good = pv[np.isfinite(pv)]
    if len(good) < 2:
        return None
    low, high = np.quantile(good, (0.05, 0.95))
    return 0.5 * float(high - low)


@contextmanager
def _within(seconds: int) -> Iterator[None]:
    """Raise TimeoutError in this block after ``seconds``, where the system has alarms and this is the main thread."""
    if not hasattr(signal, "SIGALRM") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def late(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"the loop took more than {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
