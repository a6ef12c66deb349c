"""Rows of a benchmark that goes on where it was stopped: each is a line of a file."""

import hashlib
import json
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

Row = dict[str, Any]


class Keyed(Protocol):
    """What has a name that nothing else has."""

    @property
    def key(self) -> str:
        """The name."""


R = TypeVar("R", bound=Keyed)
HERE = Path(__file__).parents[1]


def code_of(*places: str) -> str:
    """Return a digest of the sources and tables below folders of the house: rows of another version are another file's.

    >>> len(code_of("logs")), code_of("logs") == code_of("logs", "detect")
    (12, False)
    """
    digest = hashlib.sha256()
    for place in places:
        for file in sorted((HERE / place).rglob("*")):
            if file.suffix in (".py", ".npz") and "__pycache__" not in file.parts:
                digest.update(str(file.relative_to(HERE)).encode() + file.read_bytes())
    return digest.hexdigest()[:12]


def resumed(runs: Sequence[R], made: Callable[[R], Row], file: Path, seconds: float) -> Iterator[Row]:
    """Yield what each run came to: those in the file first made earlier, then new ones until ``seconds`` [s] are up."""
    file.parent.mkdir(parents=True, exist_ok=True)
    done = {row["key"]: row for row in map(json.loads, file.read_text().splitlines())} if file.exists() else {}
    until = time.monotonic() + seconds
    for run in runs:
        if run.key in done:
            yield done[run.key]
        elif time.monotonic() < until:
            row = made(run)
            with file.open("a") as out:
                out.write(json.dumps(row) + "\n")
            yield row
