"""Independent pieces of work on all cores: filters and runs go without Python's lock, so plain threads suffice."""

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from stickslip.diagram.progress import Progress, reporting
from stickslip.logs.processes import cores

Item = TypeVar("Item")
Result = TypeVar("Result")
_own = threading.local()


def in_threads(
    work: Callable[[Item], Result], items: Iterable[Item], progress: Progress = False, what: str = ""
) -> list[Result]:
    """Return the result of ``work`` on each item, in their order; the first error ends all.

    ``progress`` says how many of ``what`` are done, and which item is waited for.  Work inside other work stays in the
    thread that it is in.

    >>> in_threads(lambda x: x * x, [3, 1, 2])
    [9, 1, 4]
    """
    each, found = list(items), list[Result]()
    if not each:
        return found
    many = min(cores(), len(each))
    stop = threading.Event()
    pool = ThreadPoolExecutor(many, initializer=_begin, initargs=(stop,)) if many > 1 and not _inside() else None
    with reporting(progress, len(each), what, even=False) as tell:
        try:
            results = pool.map(work, each) if pool else map(work, each)
            for k, item in enumerate(each):
                tell(k, len(each), str(item) if what else "")
                found.append(next(results))
            tell(len(each), len(each))
        finally:
            stop.set()
            if pool is not None:
                pool.shutdown(cancel_futures=True)
    return found


def go_on() -> None:
    """End the work of a thread that nobody waits for any more, after Ctrl-C or an error: a fit takes a minute."""
    if _inside() and _own.stop.is_set():
        raise KeyboardInterrupt


def _inside() -> bool:
    return hasattr(_own, "stop")


def _begin(stop: threading.Event) -> None:
    _own.stop = stop
