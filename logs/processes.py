"""How work is laid on the cores of this machine: one thread a process, as many processes as asked."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from functools import wraps
from multiprocessing import get_all_start_methods, get_context
from types import ModuleType
from typing import Any, ParamSpec, TypeVar

__all__ = ["cores", "one_thread", "processes"]

P = ParamSpec("P")
R = TypeVar("R")


def cores() -> int:
    """Return how many cores this process may use.

    >>> cores() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function so that it computes with one thread of linear algebra, and leaves the number as it was.

    Parameters: ``function`` with any arguments.

    Our matrices are small. With two threads each of them is handed over and waited for: a diagnosis of the gap of four
    hours of a loop took 15.7 s of the processor in place of 3.3 s.

    >>> one_thread(max)(1, 2)
    2
    """

    @wraps(function)
    def alone(*args: P.args, **kwargs: P.kwargs) -> R:
        from threadpoolctl import threadpool_limits

        with threadpool_limits(1):
            return function(*args, **kwargs)

    return alone


class _Processes(ProcessPoolExecutor):
    """They do not run the caller's script again: what they compute is ours, and a script may have no main guard."""

    def submit(self, *args: Any, **kwargs: Any) -> Future[Any]:
        """Start the process that is missing, if any, and hand the work on."""
        with _script_unseen():
            return super().submit(*args, **kwargs)


@contextmanager
def _script_unseen() -> Iterator[None]:
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextmanager
def processes(count: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that Ctrl-C does not reach: a terminal sends it to all, and only the command itself is to end by it.

    Parameters: ``count`` of processes [-].

    As many processes as cores, each with as many threads of linear algebra as cores, wait for each other most of the
    time: on two cores the same work took 22 s in place of 6 s.  So each computes with one thread, and so does this
    process meanwhile.  What waits when an error or Ctrl-C ends the block is not begun.  Functions of the script that
    calls are unknown there.
    """
    from threadpoolctl import threadpool_limits

    with (
        threadpool_limits(1),
        _Processes(count, mp_context=get_context(_start()), initializer=_alone) as pool,
    ):
        try:
            yield pool
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _start() -> str:
    """Start the server that forks processes, where there is one, and return the name of the way to start them.

    A forked copy of a process with threads may hang, which a copy of the server does not.  Its copies have what it was
    started with, so they ignore Ctrl-C from their first instruction on.
    """
    if "forkserver" not in get_all_start_methods():
        return "spawn"
    if threading.current_thread() is threading.main_thread():
        from multiprocessing import forkserver

        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            with _script_unseen():
                forkserver.ensure_running()
        finally:
            signal.signal(signal.SIGINT, before)
    return "forkserver"


def _alone() -> None:
    from threadpoolctl import threadpool_limits

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)
