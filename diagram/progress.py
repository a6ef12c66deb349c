"""How far many runs have got, shown while they work."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = bool | Callable[[int, int], None] | None


@contextmanager
def reporting(progress: Progress, total: int, what: str) -> Iterator[Callable[[int, int], None]]:
    """Yield what is to be called with (done, total): the caller's function, a bar on standard error, or nothing.

    ``progress``: a function, True, False, or None for a bar if standard error is a terminal; ``what`` is counted.

    >>> with reporting(lambda done, total: print(f"{done} of {total}"), 3, "runs") as tell:
    ...     tell(2, 3)
    2 of 3
    """
    if callable(progress):
        yield progress
    elif progress or (progress is None and sys.stderr.isatty()):
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        columns = (
            BarColumn(), MofNCompleteColumn(), TextColumn(f"{what},"), TimeElapsedColumn(), TextColumn("gone,"),
            TimeRemainingColumn(), TextColumn("to go"),
        )  # fmt: skip
        with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("", total=total)
            yield lambda done, of: bar.update(task, completed=done, total=of)
    else:
        yield lambda done, _: None
