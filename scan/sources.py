"""Where the loops of a plant come from: a folder of files, one wide or long Parquet file, one text file, a query.

A source lists its jobs (some loops each) without reading their data, and a worker reads a job in one go, so that memory
holds one job a worker, however long the list. Text files of many loops are read once and kept as Parquet.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from stickslip.logs import LoopRecord, ReadError, read_log, read_loops
from stickslip.logs.files.grouping import columns_of_loops
from stickslip.logs.files.longform import LongColumns, find_long_form
from stickslip.logs.files.names import role_of
from stickslip.logs.files.size import check_cells
from stickslip.logs.files.time_names import is_date_name, is_time_name
from stickslip.scan.loop_map import LoopTags

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Job", "Source", "source_of"]

Kind = Literal["file", "wide", "long", "tags"]
Read = tuple[str, LoopRecord | str, str]  # name of a loop, its record or why there is none, and what tells files apart

PARQUET = (".parquet", ".pq")
TEXT = (".csv", ".txt", ".tsv", ".dat", ".gz", ".zip", ".xlsx", ".xlsm")
QUERY = "duckdb:"  # in front of a query in place of a file
JOB_LOOPS = 25  # loops read at once from one file: 25 of three signals and 7,200 samples take 5 MB
JOB_CELLS = 10_000_000  # numbers read at once from one file, 80 MB
JOB_FILES = 8


@dataclass(frozen=True)
class Job:
    """Loops that a worker reads and judges in one go; plain values, so that it can be sent to another machine.

    kind : {"file", "wide", "long", "tags"}
        A file that holds its own loops; columns of a wide file; tags of a long file; one file for every tag.
    files : tuple of str
    loops : tuple of (str, tuple of str)
        Each loop with its columns, tags or files; empty for "file", whose loops are found when it is read.
    beside : tuple of str
        Columns that every loop needs: time and, in a long table, tag, value and quality.
    mapped : tuple of LoopTags
        What a loop map says of these loops.
    """

    kind: Kind
    files: tuple[str, ...]
    loops: tuple[tuple[str, tuple[str, ...]], ...] = ()
    beside: tuple[str, ...] = ()
    mapped: tuple[LoopTags, ...] = ()

    def read(self) -> Iterator[Read]:
        """Each loop of the job in turn: its record, or the reason why it cannot be read."""
        if self.kind == "file":
            yield from self._of_files()
            return
        for loop, frame in self._frames():
            place = loop if self.kind == "tags" else self.files[0]
            try:
                yield loop, self._record(loop, frame), place
            except ReadError as fault:
                yield loop, _without_source(fault), place

    def _record(self, loop: str, frame: pl.DataFrame) -> LoopRecord:
        known = next((tags for tags in self.mapped if tags.loop == loop), None)
        if known is not None:
            return known.read(frame)
        records = read_loops(frame)
        return next((record for record in records if record.name == loop), records[0])

    def _of_files(self) -> Iterator[Read]:
        for file in self.files:
            try:
                if self.mapped:
                    for tags in self.mapped:
                        yield tags.loop, tags.read(file), file
                else:
                    for record in read_loops(file):
                        yield record.name, record, file
            except ReadError as fault:
                yield Path(file).stem, _without_source(fault), file

    def _frames(self) -> Iterator[tuple[str, pl.DataFrame]]:
        import polars as pl

        if self.kind == "wide":
            wanted = list(dict.fromkeys([*self.beside, *(name for _, names in self.loops for name in names)]))
            frame = pl.scan_parquet(self.files[0]).select(wanted).collect()
            for loop, names in self.loops:
                yield loop, frame.select([*self.beside, *names])
        elif self.kind == "long":
            tag = self.beside[0]
            tags = [name for _, names in self.loops for name in names]
            frame = pl.scan_parquet(self.files[0]).select(self.beside).filter(pl.col(tag).is_in(tags)).collect()
            for loop, names in self.loops:
                yield loop, frame.filter(pl.col(tag).is_in(list(names)))
        else:
            for loop, files in self.loops:
                yield loop, pl.concat([_one_tag(Path(file)) for file in files])


@dataclass(frozen=True)
class Source:
    """The loops to scan, as jobs, with the identity of their source.

    name : str
        As the user gave it.
    jobs : tuple of Job
    identity : mapping of str to plain values
        Files with their sizes and times, or a query: two scans of equal identity read the same data.
    notes : tuple of str
        What was assumed.
    """

    name: str
    jobs: tuple[Job, ...]
    identity: Mapping[str, Any]
    notes: tuple[str, ...] = field(default=())

    @property
    def count(self) -> int:
        """Number of loops as far as it is known before reading: a file counts as one."""
        return sum(len(job.loops) or max(len(job.mapped), 1) * len(job.files) for job in self.jobs)


def source_of(given: str | os.PathLike[str], kept: Path, mapped: tuple[LoopTags, ...] = ()) -> Source:
    """The source that ``given`` names: a folder, a file, or ``duckdb:SELECT ...``.

    Parameters: ``kept`` (path) Folder for the Parquet file that a text file of many loops or a query is turned into;
    ``mapped`` Loops of a loop map; without one, loops are recognised by their tags.

    Raises ReadError if there is no such source or it holds no loop.
    """
    text = os.fspath(given)
    if text.startswith(QUERY):
        return _of_query(text, kept, mapped)
    path = Path(text)
    if path.is_dir():
        return _of_folder(text, path, mapped)
    if not path.exists():
        raise ReadError(f"{text}: no such file or folder; name one, or a query as 'duckdb:SELECT ...'")
    if path.suffix.casefold() in PARQUET:
        return _of_parquet(text, path, _identity([path]), mapped)
    return _of_text(text, path, kept, mapped)


def _of_folder(name: str, path: Path, mapped: tuple[LoopTags, ...]) -> Source:
    files = sorted(file for file in path.rglob("*") if file.is_file() and _is_record(file))
    if not files:
        raise ReadError(f"{name}: the folder holds no record ({', '.join([*TEXT, *PARQUET])}); name another")
    whole, tags = _apart(files)
    notes = [f"{len(files)} files in the folder."]
    jobs: list[Job] = []
    if mapped and len(whole) != 1:
        raise ReadError(f"{name}: a loop map gives the columns of one file, and the folder holds {len(whole)}")
    if tags:
        loops = [(loop, tuple(map(str, parts))) for loop, parts in tags.items()]
        jobs += [Job("tags", (), tuple(part)) for part in _cut(loops, JOB_LOOPS)]
        notes.append(f"{sum(len(parts) for parts in tags.values())} files hold one tag each: {len(tags)} loops.")
    jobs += [Job("file", tuple(map(str, part)), mapped=mapped) for part in _cut(whole, JOB_FILES)]
    return Source(name, tuple(jobs), _identity(files), tuple(notes))


def _is_record(file: Path) -> bool:
    return file.suffix.casefold() in (*TEXT, *PARQUET) and not file.name.startswith((".", "~"))


def _apart(files: list[Path]) -> tuple[list[Path], dict[str, list[Path]]]:
    """Files that hold loops, and files of one tag each (FIC1.PV.csv, FIC1.OP.csv) by loop."""
    groups: dict[str, list[Path]] = {}
    parts: dict[str, set[str]] = {}
    for file in files:
        known = role_of(file.stem)
        if known is not None and known[0]:
            key = f"{file.parent}/{known[0]}"
            groups.setdefault(key, []).append(file)
            parts.setdefault(key, set()).add(known[1])
    tags = {key: found for key, found in groups.items() if "PV" in parts[key] and parts[key] & {"OP", "MV"}}
    taken = {file for found in tags.values() for file in found}
    return [file for file in files if file not in taken], {Path(key).name: found for key, found in tags.items()}


def _one_tag(file: Path) -> pl.DataFrame:
    """A file of one tag as rows of a long table."""
    import polars as pl

    log = read_log(file)
    values = log[log.names[0]]
    stamps: Any = log.t if log.start is None else [log.start.timestamp() + t for t in log.t.tolist()]
    return pl.DataFrame({"tag": [file.stem] * len(values), "time": stamps, "value": values})


def _of_text(name: str, path: Path, kept: Path, mapped: tuple[LoopTags, ...]) -> Source:
    identity = _identity([path])
    digest = hashlib.sha256(repr(sorted(identity.items())).encode()).hexdigest()[:16]
    target = kept / f"read-{digest}.parquet"
    if not target.exists():
        kept.mkdir(parents=True, exist_ok=True)
        read_log(path).to_parquet(target)
    return _of_parquet(name, target, identity, mapped)


def _of_query(name: str, kept: Path, mapped: tuple[LoopTags, ...]) -> Source:
    try:
        import duckdb
    except ImportError:
        raise ReadError(
            f"{name[:60]}: queries need DuckDB, which is not installed: pip install 'stickslip[historian]'"
        ) from None
    query = name.removeprefix(QUERY).strip().rstrip(";")
    digest = hashlib.sha256(query.encode()).hexdigest()[:16]
    target = kept / f"query-{digest}.parquet"
    if not target.exists():
        kept.mkdir(parents=True, exist_ok=True)
        part = target.with_suffix(".part")
        try:
            rows = duckdb.sql(query)
        except duckdb.Error as fault:
            raise ReadError(f"the query failed: {fault}") from None
        if rows is None:
            raise ReadError(f"the query gives no rows: {query[:60]}; write SELECT ...")
        rows.write_parquet(str(part))
        part.replace(target)
    return _of_parquet(name, target, {"query": query}, mapped)


def _of_parquet(name: str, path: Path, identity: Mapping[str, Any], mapped: tuple[LoopTags, ...]) -> Source:
    import polars as pl

    try:
        schema = pl.scan_parquet(path).collect_schema()
    except (pl.exceptions.PolarsError, OSError) as fault:
        raise ReadError(f"{name}: the Parquet file is damaged ({fault}); export it again") from None
    names = schema.names()
    times = [column for column in names if schema[column].is_temporal() or is_time_name(column) or is_date_name(column)]
    long = find_long_form([column for column in names if column not in times])
    if not times:
        raise ReadError(f"{name}: no column is plainly the time; the columns are {', '.join(names[:20])}")
    if long is not None:
        return _of_long(name, path, identity, times[0], long, mapped)
    found = {tags.loop: tags.columns for tags in mapped} or columns_of_loops(names)
    if not found:
        raise ReadError(f"{name}: no tag has both a PV and an output; name the loops in a map (--map loops.csv)")
    if list(found) == [""] and not name.startswith(QUERY):  # the columns name no loop: the file does
        return Source(name, (Job("file", (name,)),), identity)
    rows = pl.scan_parquet(path).select(pl.len()).collect().item()
    widest = 1 + max(map(len, found.values()))
    try:
        check_cells(rows, widest)
    except ReadError as fault:
        raise ReadError(f"{name}: {fault}") from None
    at_once = max(1, min(JOB_LOOPS, JOB_CELLS // max(1, rows * widest)))
    jobs = [
        Job("wide", (str(path),), tuple(part), (times[0],), _those(mapped, part))
        for part in _cut(list(found.items()), at_once)
    ]
    return Source(name, tuple(jobs), identity)


def _of_long(
    name: str, path: Path, identity: Mapping[str, Any], time: str, long: LongColumns, mapped: tuple[LoopTags, ...]
) -> Source:
    import polars as pl

    tags = pl.scan_parquet(path).select(pl.col(long.tag).unique().sort()).collect()[long.tag].cast(pl.String).to_list()
    found = {known.loop: known.columns for known in mapped} or columns_of_loops([tag for tag in tags if tag])
    if not found:
        raise ReadError(f"{name}: no tag has both a PV and an output; name the loops in a map (--map loops.csv)")
    beside = tuple(column for column in (long.tag, time, long.value, long.quality) if column)
    jobs = [
        Job("long", (str(path),), tuple(part), beside, _those(mapped, part))
        for part in _cut(list(found.items()), JOB_LOOPS)
    ]
    return Source(name, tuple(jobs), identity)


def _those(mapped: tuple[LoopTags, ...], part: Iterable[tuple[str, tuple[str, ...]]]) -> tuple[LoopTags, ...]:
    wanted = {loop for loop, _ in part}
    return tuple(tags for tags in mapped if tags.loop in wanted)


def _cut(items: list[Any], size: int) -> list[list[Any]]:
    return [items[i : i + size] for i in range(0, len(items), size)]


def _identity(files: Iterable[Path]) -> dict[str, Any]:
    return {str(file): [file.stat().st_size, file.stat().st_mtime_ns] for file in files}


def _without_source(fault: ReadError) -> str:
    """The reason without the name of the frame in front, which says nothing to the user."""
    return str(fault).removeprefix("polars frame: ")
