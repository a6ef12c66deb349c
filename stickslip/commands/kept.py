"""Lists computed from the package's own sources, kept with its byte code as long as no source has changed.

What the blocks and cases are is known once they are built, which takes python-control and half the house to load.
A list is kept as Python keeps byte code: with the size and the time of change of the sources, here of all of them, and
made again when one differs.  Where nothing can be written it is made each time.
"""

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path
from typing import Any

import stickslip

ROOMS = (  # those of which blocks and cases are made, and these commands
    "blocks", "cases", "commands", "detect", "diagram", "engine", "logs", "plant", "study",
)  # fmt: skip


def kept(name: str, make: Callable[[], Any], folders: Sequence[str] = stickslip.__path__) -> Any:
    """Return what ``make`` gives, in JSON's lists and objects: kept under ``name``, or made now and kept.

    The rooms are in ``folders``; the list is kept in the first of them.
    """
    path = Path(cache_from_source(os.path.join(folders[0], f"{name}.py"))).with_suffix(".json")
    stamp = stamp_of(folders)
    with suppress(OSError, ValueError, LookupError, TypeError):  # not there yet, or not what was written
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["stamp"] == stamp:
            return found["content"]
    content = json.loads(json.dumps(make()))  # so that it is the same whether it was kept or not
    if not sys.dont_write_bytecode:
        from stickslip.commands.targets import write_whole

        with suppress(OSError, ValueError):  # no place to keep it
            path.parent.mkdir(exist_ok=True)
            write_whole(path, json.dumps({"stamp": stamp, "content": content}).encode())
    return content


def stamp_of(folders: Sequence[str]) -> str:
    """Return a fingerprint of Python and of the rooms in folders: size and time of change of each Python file."""
    digest = hashlib.sha256(sys.version.encode())
    rooms = [os.path.join(folder, room) for folder in folders for room in ROOMS]
    for room in filter(os.path.isdir, rooms):
        for path, facts in sorted(_sources(room)):
            digest.update(f"{path} {facts.st_size} {facts.st_mtime_ns};".encode())
    return digest.hexdigest()


def _sources(folder: str) -> Iterator[tuple[str, os.stat_result]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield entry.path, entry.stat()
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _sources(entry.path)
