"""Where the rows of a study live until all are there: in memory, or in a folder that survives an interruption.

study.json              the request and how far it got        parts/*.parquet     rows, in the order they were finished
study.parquet           all rows in the order of the runs, written when the last one is there

Every file is written beside its place and renamed, so a folder never holds half a file.  A part may hold any runs:
the next call reads which are there and makes the others, and the final file does not tell how often it was begun.
"""

import contextlib
import io
import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from logs.files.write import replacing
from study.axes import StudyError
from study.request import SCHEMA, differences

if TYPE_CHECKING:
    import polars as pl

TABLE, MANIFEST, PARTS, LOCK = "study.parquet", "study.json", "parts", ".lock"


class Store(Protocol):
    """Keeps finished rows."""

    def rows(self) -> "list[pl.DataFrame]":
        """Return the rows kept so far, in tables of one schema."""

    def add(self, table: "pl.DataFrame") -> None:
        """Keep more rows."""


class Memory:
    """Keeps rows as long as the call lasts."""

    def __init__(self) -> None:
        self.tables: list[pl.DataFrame] = []

    def rows(self) -> "list[pl.DataFrame]":
        """Return the rows kept so far."""
        return self.tables

    def add(self, table: "pl.DataFrame") -> None:
        """Keep more rows."""
        self.tables.append(table)


class Folder:
    """Keeps rows in a folder; see the module docstring."""

    def __init__(self, path: Path, request: Mapping[str, Any]) -> None:
        self.path, self.request = path, request

    def rows(self) -> "list[pl.DataFrame]":
        """Return the rows kept so far; a part that cannot be read is thrown away, its runs are made again.

        Raises ``StudyError`` if the finished table cannot be read.
        """
        import polars as pl

        whole = self.path / TABLE
        if whole.exists():
            try:
                return [pl.read_parquet(whole)]
            except pl.exceptions.PolarsError:
                raise StudyError(f"'{whole}' is damaged; fresh starts anew (--fresh)") from None
        found = []
        for part in sorted((self.path / PARTS).glob("*.parquet")):
            try:
                found.append(pl.read_parquet(part))
            except pl.exceptions.PolarsError:
                part.unlink()
        return found

    def add(self, table: "pl.DataFrame") -> None:
        """Write one part."""
        (self.path / PARTS).mkdir(exist_ok=True)
        write(self.path / PARTS / f"{int(table['run'][0]):09d}.parquet", parquet(table))

    def note(self, **progress: Any) -> None:
        """Write study.json: the request and what is known besides it."""
        content = {"schema": SCHEMA, "request": self.request, **progress}
        write(self.path / MANIFEST, (json.dumps(content, indent=2, allow_nan=False) + "\n").encode())

    def forget(self) -> None:
        """Throw away all that is there."""
        for name in (TABLE, MANIFEST):
            (self.path / name).unlink(missing_ok=True)
        shutil.rmtree(self.path / PARTS, ignore_errors=True)

    def finish(self, table: "pl.DataFrame") -> None:
        """Write study.parquet and throw the parts away."""
        write(self.path / TABLE, parquet(table, self.request))
        shutil.rmtree(self.path / PARTS, ignore_errors=True)


@contextlib.contextmanager
def opened(path: Path, request: Mapping[str, Any], fresh: bool) -> Iterator[Folder]:
    """Hold a folder for one request: a new one, or one that holds rows of the same request.

    ``fresh`` throws away what another study left there.  Raises ``StudyError`` if the folder holds another study, or
    another process works in it, or it cannot be.
    """
    from filelock import FileLock, Timeout

    try:
        path.mkdir(parents=True, exist_ok=True)
        lock = FileLock(path / LOCK, timeout=0)
        lock.acquire()
    except Timeout:
        raise StudyError(f"another study is at work in '{path}'; wait for it, or name another folder") from None
    except OSError as fault:
        raise StudyError(f"'{path}' cannot be a study's folder ({fault.strerror}); name another") from None
    folder = Folder(path, request)
    try:
        if fresh:
            folder.forget()
        _check(path, request)
        yield folder
    finally:
        lock.release()  # the file stays: deleting it could let two in


def _check(path: Path, request: Mapping[str, Any]) -> None:
    manifest = path / MANIFEST
    if not manifest.exists():
        others = [name for name in (TABLE, PARTS) if (path / name).exists()]
        if others:
            raise StudyError(
                f"'{path}' holds {', '.join(others)} of a study without its {MANIFEST}; fresh starts anew (--fresh)"
            )
        return
    try:
        found = dict(json.loads(manifest.read_text())["request"])
        phrases = differences(json.loads(json.dumps(request)), found)
    except (OSError, ValueError, KeyError, TypeError):
        raise StudyError(f"'{manifest}' cannot be read as a study; fresh starts anew (--fresh)") from None
    if phrases:
        told = "; ".join(phrases[:6])
        raise StudyError(
            f"'{path}' holds another study ({told}); give the same request to go on with it, name another folder, or "
            "throw it away with fresh (--fresh)"
        )


def joined(tables: "Sequence[pl.DataFrame]") -> "pl.DataFrame":
    """Return all rows in the order of the runs."""
    import polars as pl

    return pl.concat(tables, how="vertical").sort("run").rechunk()


def parquet(table: "pl.DataFrame", request: Mapping[str, Any] | None = None) -> bytes:
    """Return a table as the bytes of a Parquet file; equal tables give equal bytes."""
    content = io.BytesIO()
    metadata = None if request is None else {"stickslip": json.dumps({"schema": SCHEMA, "request": request})}
    table.write_parquet(content, compression="zstd", row_group_size=100_000, metadata=metadata)
    return content.getvalue()


def write(path: Path, content: bytes) -> None:
    """Write a file completely or not at all: beside its place first, then renamed."""
    with replacing(path) as part:
        part.write_bytes(content)
