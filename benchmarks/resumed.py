"""Rows of a benchmark that goes on where it was stopped: each is a line of a file."""

import hashlib
import json
import time
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar

from stickslip.logs.files.write import replacing

Row = dict[str, Any]


class Keyed(Protocol):
    """What has a name that nothing else has."""

    @property
    def key(self) -> str:
        """The name."""


class Kinded(Keyed, Protocol):
    """What has a name of its own and is one of a kind."""

    @property
    def kind(self) -> Hashable:
        """What it counts among."""


R = TypeVar("R", bound=Keyed)
K = TypeVar("K", bound=Kinded)
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


def in_turn(runs: Sequence[K]) -> list[K]:
    """Return the runs in an order of which every beginning holds each kind by its share, so that it may stop anywhere.

    Which of a kind comes first follows from a digest of its key: always the same, and of no effect in particular.
    """
    of, before = Counter(run.kind for run in runs), Counter[Hashable]()
    place = {}
    for digest, run in sorted(((_digest(run.key), run) for run in runs), key=lambda one: one[0]):
        place[run.key] = ((before[run.kind] + 0.5) / of[run.kind], digest)
        before[run.kind] += 1
    return sorted(runs, key=lambda run: place[run.key])


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()


def part_file(folder: Path, name: str, part: tuple[int, int]) -> Path:
    """Return the file of rows of one part, (k, of) from 1 on; (0, 0) is the whole.

    >>> part_file(Path("rows"), "plant", (2, 3)).name, part_file(Path("rows"), "plant", (0, 0)).name
    ('plant_2_of_3.jsonl', 'plant.jsonl')
    """
    k, of = part
    return folder / (f"{name}_{k}_of_{of}.jsonl" if of else f"{name}.jsonl")


def resumed(
    runs: Sequence[R], made: Callable[[R], Row], file: Path, seconds: float, also: Iterable[Path] = ()
) -> Iterator[Row]:
    """Yield what each run came to: those in the file made earlier, new ones until ``seconds`` [s] are up.

    ``also``: files of rows that other processes made.  Each row is kept at once, and no file is ever half written.
    """
    file.parent.mkdir(parents=True, exist_ok=True)
    kept = file.read_text() if file.exists() else ""
    earlier = [one for one in (*also, file) if one.exists()]
    done = {row["key"]: row for one in earlier for row in map(json.loads, one.read_text().splitlines())}
    until = time.monotonic() + seconds
    for run in runs:
        if run.key in done:
            yield done[run.key]
        elif time.monotonic() < until:
            row = made(run)
            kept += json.dumps(row) + "\n"
            with replacing(file) as part:
                part.write_text(kept)
            yield row
