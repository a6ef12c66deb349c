"""Say on standard error that something is being compiled, because nothing else would be seen for a minute.

Each function is compiled when a record first needs it, so that several first runs may each have a part to compile.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import event
from numba.core.dispatcher import Dispatcher

ENGINE = "simulation engine"
_TOLD: dict[str, Any] = {}  # what -> the stream that has the line: in one run it is said once


class _Counter(event.Listener):  # type: ignore[misc]
    """Counts the functions that numba begins to compile; what it finds in its cache it does not compile."""

    def __init__(self, tell: Callable[[int], None]) -> None:
        self.begun, self.tell = 0, tell

    def on_start(self, event: Any) -> None:
        self.begun += 1
        self.tell(self.begun)

    def on_end(self, event: Any) -> None:
        pass


@contextmanager
def noticed(what: str = ENGINE) -> Iterator[None]:
    """While ``what`` is being compiled, say so: on a terminal how far it has got, elsewhere one line."""
    status: Any = None
    total = 0

    def tell(begun: int) -> None:
        nonlocal status, total
        if begun == 1 and sys.stderr is not None and not sys.stderr.isatty():
            if _TOLD.get(what) is not sys.stderr:
                sys.stderr.write(f"stickslip: compiling what is new here of the {what}, once; up to a minute\n")
                sys.stderr.flush()
            _TOLD[what] = sys.stderr
        elif sys.stderr is not None and sys.stderr.isatty():
            total = total or _of_engine()
            of = f" of {max(begun, total)}" if what == ENGINE else ""
            words = f"compiling what is new here of the {what}, once: {begun}{of} functions"
            if status is None:
                from rich.console import Console

                status = Console(stderr=True).status(words)
                status.start()
            status.update(words)

    try:
        with event.install_listener("numba:compile", _Counter(tell)):
            yield
    finally:
        if status is not None:
            status.stop()


def _of_engine() -> int:
    """Return how many functions of the engine are to be compiled."""
    rooms = [module for name, module in [*sys.modules.items()] if name.startswith("stickslip.engine.")]
    return len({id(f) for module in rooms for f in vars(module).values() if isinstance(f, Dispatcher)})
