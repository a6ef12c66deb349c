"""Jobs on the cores of this machine, or on a Dask cluster: the same rows, in the order in which they are finished.

A loop that brings its process down (memory, a fault in compiled code) must not end a scan: the jobs that were under way
are then done again, loop by loop, each in a process of its own, and what falls again is an error in its row.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

from stickslip.logs import ReadError
from stickslip.logs.cluster import LOST, ClusterError
from stickslip.logs.cluster import on_cluster as results
from stickslip.logs.processes import cores, processes
from stickslip.scan.judge import JOB_ROWS, Row, judged
from stickslip.scan.sources import Job

__all__ = ["on_cluster", "on_cores"]

Numbered = tuple[int, Job]
AHEAD = 2  # jobs that wait for each process, so that a list of thousands is not sent at once


def on_cores(jobs: Sequence[Numbered], workers: int | None = None) -> Iterator[list[Row]]:
    """Yield the rows of one job after another, as ``workers`` processes finish them (by default one process a core)."""
    count = workers or cores()
    if count == 1 or len(jobs) == 1:
        for number, job in jobs:
            yield judged(job, number)
        return
    left = list(jobs)
    while left:
        fallen: list[Numbered] = []
        with processes(count) as pool:
            under_way: dict[Future[list[Row]], Numbered] = {}
            while (left or under_way) and not fallen:
                while left and len(under_way) < AHEAD * count:
                    number, job = left.pop(0)
                    under_way[pool.submit(judged, job, number)] = (number, job)
                ready, _ = wait(under_way, return_when=FIRST_COMPLETED)
                for future in ready:
                    try:
                        rows = future.result()
                    except BrokenProcessPool:
                        fallen = sorted(under_way.values(), key=lambda item: item[0])
                        break
                    del under_way[future]
                    yield rows
        for number, job in fallen:
            yield _one_by_one(number, job)


def _one_by_one(number: int, job: Job) -> list[Row]:
    """The rows of a job of which some loop brings its process down."""
    rows: list[Row] = []
    for part in _singles(job):
        with processes(1) as pool:
            try:
                found = pool.submit(judged, part, number).result()
            except BrokenProcessPool:
                name = part.loops[0][0] if part.loops else part.files[0]
                found = [{"loop": name, "error": "the process that judged this loop ended without an answer"}]
        rows += [row | {"order": number * JOB_ROWS + len(rows) + i} for i, row in enumerate(found)]
    return rows


def _singles(job: Job) -> list[Job]:
    """The job as jobs of one loop or one file each."""
    if job.loops:
        return [replace(job, loops=(loop,)) for loop in job.loops]
    return [replace(job, files=(file,)) for file in job.files]


def on_cluster(jobs: Sequence[Numbered], address: str) -> Iterator[list[Row]]:
    """The rows of each job, from the workers of the Dask scheduler at ``address``.

    A job whose worker is lost goes to another. Raises ReadError if Dask is missing or the scheduler does not answer.
    """
    try:
        for number, rows in results(judged, [(job, number) for number, job in jobs], address):
            yield _one_by_one(*jobs[number]) if rows is LOST else rows
    except ClusterError as fault:
        raise ReadError(str(fault)) from None
