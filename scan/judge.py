"""One loop of a scan: read, judged, and put into one row of plain values."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from stickslip.logs import LoopRecord
from stickslip.logs.time_limit import time_limit
from stickslip.scan.sources import Job
from stickslip.scan.together import phasors

if TYPE_CHECKING:
    from stickslip.detect.judge.answer import Amount, Answer
    from stickslip.detect.prepare.prepared import Prepared

__all__ = ["LOOP_MAX_S", "judged", "row_of", "row_of_valve"]

LOOP_MAX_S = 60  # s for one loop; the calibrated answer takes a tenth of a second
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
            with time_limit(LOOP_MAX_S, f"the loop took more than {LOOP_MAX_S} s"):
                name, record, place = next(read, ("", None, ""))
                if record is None:
                    return rows
                row = {"loop": name, "error": record} if isinstance(record, str) else row_of(record)
                row["source"] = place
        except Exception as fault:  # a scan overnight must not end at one loop
            row = {"loop": name or f"job {number}", "error": f"{type(fault).__name__}: {fault}"[:REASON_MAX]}
        rows.append(row | {"order": number * JOB_ROWS + len(rows)})


def row_of(record: LoopRecord) -> Row:
    """Return the row of one record: the calibrated answer and the oscillation, without the single methods."""
    from stickslip.detect.judge.over_days import answer_over_days
    from stickslip.detect.prepare.prepared import prepared

    loop = prepared(record)
    return _row_of(record.name, answer_over_days(loop), [loop])


def row_of_valve(name: str, records: Sequence[LoopRecord]) -> Row:
    """What a scan says of one valve by several records: the pooled answer; all else is of the last one."""
    from stickslip.detect.prepare.prepared import prepared
    from stickslip.detect.tag import judge_tag

    loops = [prepared(record) for record in records]
    return _row_of(name, judge_tag(name, loops).answer, loops)


def _row_of(name: str, found: Answer, loops: Sequence[Prepared]) -> Row:
    from stickslip.detect.signals.swing import amplitude

    loop = loops[-1]
    record = loop.record
    t, start = record.t, record.log.start
    period = loop.period if loop.gate.oscillating else None
    cause = next(iter(found.causes), None)
    limit = None if found.limit is None else found.limit[0]
    return {
        "loop": name,
        "verdict": found.word,
        "probability": found.probability,
        "cause": cause,
        "cause_probability": None if cause is None else found.causes[cause],
        **_sizes("S", found.S),
        **_sizes("J", found.J),
        "detection_limit": limit,
        "size_unit": next((size.unit for size in (found.S, found.J) if size), found.limit[1] if found.limit else None),
        "period_s": period,
        "amplitude": amplitude(record.pv),
        "health": ", ".join(dict.fromkeys(fact.code for one in loops for fact in one.health if fact.present)),
        "reason": found.reason[:REASON_MAX],
        "action": found.action[:REASON_MAX],
        "samples": len(t),
        "interval_s": float(record.dt),
        "hours": float(t[-1] - t[0]) / 3600.0,
        "start": None if start is None else float(t[0]) + start.timestamp(),
        "phasors": None if period is None else phasors(t - t[0], record.pv, period),
    }


def _sizes(name: str, size: Amount | None) -> Row:
    if size is None:
        return {}
    return {name: size.value, f"{name}_low": size.low, f"{name}_high": size.high}
