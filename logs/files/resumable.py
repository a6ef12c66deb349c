"""Rows made part by part, kept in a folder that survives an interruption.

NAME.json              the request and how far it got         parts/*.parquet     rows, in the order they were finished
NAME.parquet           all rows in their order, written when the last one is there

Every file is written beside its place and renamed, so a folder never holds half a file.  A part may hold any rows:
the next call reads which are there and makes the others, and the final file does not tell how often it was begun.
"""

from __future__ import annotations

import contextlib
import io
import json
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.logs.files.write import replacing

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Kept", "RowsFolder", "differences", "joined", "opened", "parquet", "write"]

PARTS, LOCK = "parts", ".lock"
LONGEST_VALUE_CHARACTERS = 60  # characters of a value in a message


@dataclass(frozen=True)
class Kept:
    """The kind of rows that a folder keeps.

    name : str
        Of the files, and in messages: "study".
    schema : str
        Written into the files.
    key : str
        Column of whole numbers that tells the order of the rows.
    error : type of exception
        Raised where the folder cannot be used.
    phrases_of : function (wanted, found) -> list of str
        What differs between two requests, a phrase each.
    """

    name: str
    schema: str
    key: str
    error: type[ValueError]
    phrases_of: Callable[[Mapping[str, Any], Mapping[str, Any]], list[str]]

    @property
    def table(self) -> str:
        """Name of the file with all rows."""
        return f"{self.name}.parquet"

    @property
    def manifest(self) -> str:
        """Name of the file with the request."""
        return f"{self.name}.json"


class RowsFolder:
    """Keeps rows in a folder; see the module."""

    def __init__(self, path: Path, request: Mapping[str, Any], kept: Kept) -> None:
        self.path, self.request, self.kept = path, request, kept

    def rows(self) -> list[pl.DataFrame]:
        """The rows kept so far; a part that cannot be read is thrown away, its rows are made again.

        Raises the error of its kind if the finished table cannot be read.
        """
        import polars as pl

        whole = self.path / self.kept.table
        if whole.exists():
            try:
                return [pl.read_parquet(whole)]
            except pl.exceptions.PolarsError:
                raise self.kept.error(f"'{whole}' is damaged; fresh starts anew (--fresh)") from None
        found = []
        for part in sorted((self.path / PARTS).glob("*.parquet")):
            try:
                found.append(pl.read_parquet(part))
            except pl.exceptions.PolarsError:
                part.unlink()
        return found

    def firsts(self) -> set[int]:
        """The keys that the parts kept so far begin with, without reading them."""
        return {int(part.stem) for part in (self.path / PARTS).glob("*.parquet")}

    def add(self, table: pl.DataFrame) -> None:
        """Write one part."""
        (self.path / PARTS).mkdir(exist_ok=True)
        write(self.path / PARTS / f"{int(table[self.kept.key][0]):09d}.parquet", parquet(table))

    def note(self, **progress: Any) -> None:
        """Write NAME.json: the request and what is known besides it."""
        content = {"schema": self.kept.schema, "request": self.request, **progress}
        write(self.path / self.kept.manifest, (json.dumps(content, indent=2, allow_nan=False) + "\n").encode())

    def forget(self) -> None:
        """Throw away all that is there."""
        for name in (self.kept.table, self.kept.manifest):
            (self.path / name).unlink(missing_ok=True)
        shutil.rmtree(self.path / PARTS, ignore_errors=True)

    def finish(self, table: pl.DataFrame) -> None:
        """Write NAME.parquet and throw the parts away."""
        document = {"schema": self.kept.schema, "request": self.request}
        write(self.path / self.kept.table, parquet(table, document))
        shutil.rmtree(self.path / PARTS, ignore_errors=True)


@contextlib.contextmanager
def opened(path: Path, request: Mapping[str, Any], kept: Kept, fresh: bool) -> Iterator[RowsFolder]:
    """Hold a folder for one request: a new one, or one that holds rows of the same request.

    ``fresh`` throws away what another request left there.  Raises the error of its kind if the folder holds rows of
    another request, or another process works in it, or it cannot be.
    """
    from filelock import FileLock, Timeout

    try:
        path.mkdir(parents=True, exist_ok=True)
        lock = FileLock(path / LOCK, timeout=0)
        lock.acquire()
    except Timeout:
        raise kept.error(f"another {kept.name} is at work in '{path}'; wait for it, or name another folder") from None
    except OSError as fault:
        raise kept.error(f"'{path}' cannot be a {kept.name}'s folder ({fault.strerror}); name another") from None
    folder = RowsFolder(path, request, kept)
    try:
        if fresh:
            folder.forget()
        _check(folder)
        yield folder
    finally:
        lock.release()  # the file stays: deleting it could let two in


def _check(folder: RowsFolder) -> None:
    path, kept = folder.path, folder.kept
    manifest = path / kept.manifest
    if not manifest.exists():
        others = [name for name in (kept.table, PARTS) if (path / name).exists()]
        if others:
            raise kept.error(
                f"'{path}' holds {', '.join(others)} of a {kept.name} without its {kept.manifest}; "
                "fresh starts anew (--fresh)"
            )
        return
    try:
        found = dict(json.loads(manifest.read_text())["request"])
        phrases = kept.phrases_of(json.loads(json.dumps(folder.request)), found)
    except (OSError, ValueError, KeyError, TypeError):
        raise kept.error(f"'{manifest}' cannot be read as a {kept.name}; fresh starts anew (--fresh)") from None
    if phrases:
        phrases_of = "; ".join(phrases[:6])
        raise kept.error(
            f"'{path}' holds another {kept.name} ({phrases_of}); give the same request to go on with it, name another "
            "folder, or throw it away with fresh (--fresh)"
        )


def differences(
    wanted: Mapping[str, Any], found: Mapping[str, Any], phrases_of: Mapping[str, str], prefix: str = ""
) -> list[str]:
    """What differs between a new request and one that a folder holds, a phrase each.

    ``phrases_of`` gives the phrase for keys whose values mean nothing to a reader.

    >>> differences({"seed": 1, "code": "a1"}, {"seed": 2, "code": "b2"}, {"code": "stickslip has changed since"})
    ['seed: there 2, now 1', 'stickslip has changed since']
    """
    phrases = []
    for key in dict.fromkeys([*wanted, *found]):
        new, old = wanted.get(key), found.get(key)
        if new == old:
            continue
        if isinstance(new, Mapping) and isinstance(old, Mapping):
            phrases += differences(new, old, phrases_of, f"{prefix}{key} ")
        else:
            phrases.append(phrases_of.get(key) or f"{prefix}{key}: there {_short(old)}, now {_short(new)}")
    return phrases


def _short(value: object) -> str:
    if value is None:
        return "not given"
    text = json.dumps(value) if not isinstance(value, str) else value
    return (
        text if len(text) <= LONGEST_VALUE_CHARACTERS else f"{text[: LONGEST_VALUE_CHARACTERS - 20]} ... {text[-15:]}"
    )


def joined(tables: Sequence[pl.DataFrame], key: str) -> pl.DataFrame:
    """All rows in the order of their key."""
    import polars as pl

    return pl.concat(tables, how="vertical").sort(key).rechunk()


def parquet(table: pl.DataFrame, document: Mapping[str, Any] | None = None) -> bytes:
    """A table as the bytes of a Parquet file, with a document in its footer; equal tables give equal bytes."""
    content = io.BytesIO()
    metadata = None if document is None else {"stickslip": json.dumps(document)}
    table.write_parquet(content, compression="zstd", row_group_size=100_000, metadata=metadata)
    return content.getvalue()


def write(path: Path, content: bytes) -> None:
    """Write a file completely or not at all: beside its place first, then renamed."""
    with replacing(path) as part:
        part.write_bytes(content)
