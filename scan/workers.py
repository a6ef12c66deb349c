"""Jobs on the cores of this machine, or on a Dask cluster: the same rows, in the order in which they are finished.

A loop that brings its process down (memory, a fault in compiled code) must not end a scan: the jobs that were under way
are then done again, loop by loop, each in a process of its own, and what falls again is an error in its row.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing import forkserver, get_context

from logs import ReadError
from logs.cluster import LOST, ClusterError
from logs.cluster import on_cluster as results
from scan.judge import JOB_ROWS, Row, judged
from scan.sources import Job

__all__ = ["on_cluster", "on_cores"]

Numbered = tuple[int, Job]
AHEAD = 2  # jobs that wait for each process, so that a list of thousands is not sent at once
START = "forkserver"  # a forked copy of a process with threads may hang


def on_cores(jobs: Sequence[Numbered], workers: int | None = None) -> Iterator[list[Row]]:
    """The rows of each job, from ``workers`` processes (default: one a core)."""
    from os import cpu_count

    count = workers or cpu_count() or 1
    if count == 1 or len(jobs) == 1:
        for number, job in jobs:
            yield judged(job, number)
        return
    left = list(jobs)
    while left:
        fallen: list[Numbered] = []
        with _processes(count) as pool:
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


@contextmanager
def _processes(count: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that Ctrl-C does not reach: a terminal sends it to all, and only the command itself is to end by it.

    They have what the server that forks them was started with, so it is ignored from their first instruction on.  What
    waits for them when the command ends by an error is not begun.
    """
    if threading.current_thread() is threading.main_thread():
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            forkserver.ensure_running()
        finally:
            signal.signal(signal.SIGINT, before)
    with ProcessPoolExecutor(count, mp_context=get_context(START), initializer=_ignoring) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _ignoring() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _one_by_one(number: int, job: Job) -> list[Row]:
    """The rows of a job of which some loop brings its process down."""
    rows: list[Row] = []
    for part in _singles(job):
        with _processes(1) as pool:
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
