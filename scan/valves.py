"""Valves of which a scan holds several records: one row each, judged by all of its records together.

Records of one valve share their tag but for a date or number at its end (``stickslip.logs.tags.valve_in``) and lie in
one folder. They are read once more, because a row says too little to be pooled; a valve that fails keeps the rows of
its records.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.logs import LoopRecord
from stickslip.logs.processes import cores, processes
from stickslip.logs.tags import valve_in
from stickslip.logs.time_limit import time_limit
from stickslip.scan.judge import JOB_ROWS, LOOP_MAX_S, Row, row_of_valve
from stickslip.scan.sources import Job, Source
from stickslip.scan.table import table_of

if TYPE_CHECKING:
    import polars as pl

__all__ = ["records_at", "with_valves"]

RECORDS_MAX = 60  # records of one valve, the last ones: two months of days
Place = tuple[int, Job, tuple[int, ...]]  # number of a job, the job, and which of its records


def with_valves(source: Source, table: pl.DataFrame, workers: int | None) -> pl.DataFrame:
    """The table in which the rows of one valve's records have become one."""
    import polars as pl

    groups = _groups(table)
    if not groups:
        return table
    asked = [(name, _places(source, orders)) for name, orders in groups]
    rows: list[Row] = []
    gone: list[int] = []
    for (_, orders), row in zip(groups, _judged(asked, workers), strict=True):
        if row is not None:
            first = table.filter(pl.col("order") == orders[0]).row(0, named=True)
            rows.append({"source": first["source"]} | row | {"order": orders[0]})
            gone += orders
    left = table.filter(~pl.col("order").is_in(gone))
    return pl.concat([left, table_of(rows)]).sort("order")


def records_at(source: Source, orders: Sequence[int]) -> Iterator[tuple[int, LoopRecord | str]]:
    """The records with these values of the column ``order``, each with its order; or why one cannot be read."""
    for number, job, places in _places(source, orders):
        for place, record in _read(job, places):
            yield number * JOB_ROWS + place, record


def _groups(table: pl.DataFrame) -> list[tuple[str, list[int]]]:
    """The valves of several records that could be judged, each with the orders of its records."""
    found: dict[tuple[str, str], list[int]] = {}
    for row in table.select("order", "loop", "verdict", "source").iter_rows(named=True):
        if row["verdict"] and row["verdict"] != "not_applicable":
            key = (str(Path(row["source"] or "").parent), valve_in(row["loop"]))
            found.setdefault(key, []).append(row["order"])
    return [(name, orders[-RECORDS_MAX:]) for (_, name), orders in found.items() if len(orders) > 1]


def _places(source: Source, orders: Sequence[int]) -> list[Place]:
    by_job: dict[int, list[int]] = {}
    for order in orders:
        by_job.setdefault(order // JOB_ROWS, []).append(order % JOB_ROWS)
    return [(number, source.jobs[number], tuple(sorted(places))) for number, places in by_job.items()]


def _read(job: Job, places: Sequence[int]) -> Iterator[tuple[int, LoopRecord | str]]:
    """Some of a job's records, each with its place."""
    for place, (_, record, _) in enumerate(job.read()):
        if place in places:
            yield place, record
        if place >= places[-1]:
            return


def _judged(asked: Sequence[tuple[str, list[Place]]], workers: int | None) -> Iterator[Row | None]:
    """The row of each valve; None where that fails."""
    count = workers or cores()
    if count == 1 or len(asked) == 1:
        yield from (_row(name, places) for name, places in asked)
        return
    with processes(count) as pool:
        yield from pool.map(_row, *(list(part) for part in zip(*asked, strict=True)))


def _row(name: str, places: Sequence[Place]) -> Row | None:
    """The row of one valve."""
    try:
        with time_limit(LOOP_MAX_S, f"the valve took more than {LOOP_MAX_S} s"):
            found = [(number * JOB_ROWS + at, record) for number, job, own in places for at, record in _read(job, own)]
            records = [(order, record) for order, record in found if isinstance(record, LoopRecord)]
            row = row_of_valve(name, [record for _, record in records])
            return row | {"records": " ".join(str(order) for order, _ in records)}
    except Exception:  # its records keep their own rows
        return None
