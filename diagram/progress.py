"""How far many runs have got, shown while they work."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

Progress = bool | Callable[[int, int], None] | None


class Tell(Protocol):
    """Says that ``done`` of ``total`` are done, and what is worked at ``now``."""

    def __call__(self, done: int, total: int, now: str = "") -> None:
        """Say so."""


@contextmanager
def reporting(progress: Progress, total: int, what: str, even: bool = True) -> Iterator[Tell]:
    """Yield what is to be called with (done, total): the caller's function, a bar on standard error, or nothing.

    ``progress``: a function, True, False, or None for a bar if standard error is a terminal; ``what`` is counted;
    ``even``: whether each takes about as long, so that the bar can say how long the rest takes.  The bar also shows
    what is worked at now.

    >>> with reporting(lambda done, total: print(f"{done} of {total}"), 3, "runs") as tell:
    ...     tell(2, 3)
    2 of 3
    """
    if callable(progress):
        yield lambda done, total, now="": progress(done, total)
    elif progress or (progress is None and sys.stderr.isatty()):
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        left = (TextColumn("gone,"), TimeRemainingColumn(), TextColumn("to go")) if even else (TextColumn("gone"),)
        columns = (
            BarColumn(), MofNCompleteColumn(), TextColumn(f"{what},"), TimeElapsedColumn(), *left,
            TextColumn("{task.description}"),
        )  # fmt: skip
        with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("", total=total)
            yield lambda done, total, now="": bar.update(task, completed=done, total=total, description=now)
    else:
        yield lambda done, total, now="": None
