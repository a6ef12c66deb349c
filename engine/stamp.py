"""Keep compiled code and its sources together.

Numba keeps compiled code per source file and does not notice when another file that it took a constant or a
helper from has changed: a changed layout beside an unchanged sweep would run into foreign memory.  So all compiled
files of the engine carry one stamp of all its sources and are thrown away together, under a lock, because tests and
workers start side by side.  Kernels reach beyond their folder: see ``reach``.
"""

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numba
from filelock import FileLock

_checked: set[Path] = set()


def stamp_of(sources: Path) -> str:
    """Return a fingerprint of all Python files of a folder and of the compiler."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(sources.glob("*.py")):
        facts = path.stat()
        digest.update(f"{path.name} {facts.st_size} {facts.st_mtime_ns};".encode())
    return digest.hexdigest()


@contextmanager
def locked(cache: Path) -> Iterator[None]:
    """Hold the lock of a cache folder.

    Raises ``OSError`` if the cache cannot be written.
    """
    cache.mkdir(parents=True, exist_ok=True)
    with FileLock(cache / "stickslip.lock", timeout=300):
        yield


@contextmanager
def fresh(cache: Path, sources: Path) -> Iterator[None]:
    """Hold the lock of a cache folder, after deleting what does not belong to the present sources.

    Raises ``OSError`` if the cache cannot be written.
    """
    with locked(cache):
        if cache not in _checked:
            mark, stamp = cache / "stickslip.stamp", stamp_of(sources)
            if not mark.exists() or mark.read_text() != stamp:
                for pattern in ("*.nbi", "*.nbc"):
                    for path in cache.glob(pattern):
                        path.unlink(missing_ok=True)
                mark.write_text(stamp)
            _checked.add(cache)
        yield
