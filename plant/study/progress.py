"""How far a study has got, told while it works, and whether somebody asked it to stop."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

Progress = bool | Callable[[int, int], None] | None


@contextmanager
def told(progress: Progress, runs: int) -> Iterator[Callable[[int, int], None]]:
    """Yield what is called with (done, runs): a bar on standard error, the caller's function, or nothing."""
    if callable(progress):
        yield progress
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    if not (progress or (progress is None and console.is_terminal)):
        yield lambda done, _: None
        return
    columns = (
        BarColumn(), MofNCompleteColumn(), TextColumn("runs,"), TimeElapsedColumn(), TextColumn("gone,"),
        TimeRemainingColumn(), TextColumn("to go"),
    )  # fmt: skip
    with Bar(*columns, console=console, transient=True) as bar:
        task = bar.add_task("", total=runs)
        yield lambda done, _: bar.update(task, completed=done)


@contextmanager
def stop_asked() -> Iterator[Callable[[], bool]]:
    """Yield a function that tells whether Ctrl-C was pressed.

    An ensemble ends quietly on Ctrl-C; if its members were just finished, nothing of it is left to see.
    """
    asked = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield asked.is_set
        return
    handler: Callable[[int, FrameType | None], object] = before

    def note(number: int, frame: FrameType | None) -> None:
        asked.set()
        handler(number, frame)

    signal.signal(signal.SIGINT, note)
    try:
        yield asked.is_set
    finally:
        signal.signal(signal.SIGINT, before)
