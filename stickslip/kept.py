"""Lists computed from the package's own sources, kept with its byte code as long as no source has changed.

What the blocks and cases are is known once they are built, which takes python-control and half the house to load.
A list is kept as Python keeps byte code: with the size and the time of change of the sources, here of all of them, and
made again when one differs.  Where nothing can be written it is made each time.
"""

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path
from typing import Any

from stickslip.shadow import PACKAGES

ROOT = Path(__file__).resolve().parent.parent


def kept(name: str, make: Callable[[], Any], root: Path = ROOT) -> Any:
    """Return what ``make`` gives, in JSON's lists and objects: kept under ``name``, or made now and kept.

    ``root`` is the folder of the packages.
    """
    path = Path(cache_from_source(str(root / "stickslip" / f"{name}.py"))).with_suffix(".json")
    stamp = stamp_of(root)
    with suppress(OSError, ValueError, LookupError, TypeError):  # not there yet, or not what was written
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["stamp"] == stamp:
            return found["content"]
    content = json.loads(json.dumps(make()))  # so that it is the same whether it was kept or not
    if not sys.dont_write_bytecode:
        from stickslip.targets import write_whole

        with suppress(OSError, ValueError):  # no place to keep it
            path.parent.mkdir(exist_ok=True)
            write_whole(path, json.dumps({"stamp": stamp, "content": content}).encode())
    return content


def stamp_of(root: Path) -> str:
    """Return a fingerprint of Python and of the packages in a folder: size and time of change of each Python file."""
    digest = hashlib.sha256(sys.version.encode())
    for name in (*PACKAGES, "stickslip"):
        for path, facts in sorted(_sources(str(root / name))):
            digest.update(f"{path} {facts.st_size} {facts.st_mtime_ns};".encode())
    return digest.hexdigest()


def _sources(folder: str) -> Iterator[tuple[str, os.stat_result]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.endswith(".py"):
                yield entry.path, entry.stat()
            elif entry.is_dir() and entry.name != "__pycache__":
                yield from _sources(entry.path)
