"""A scan: jobs spread over the cores of this machine or of a cluster, their rows kept as they come in."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.logs.files.resumable import Kept, RowsFolder, differences, joined, opened
from stickslip.scan.changes import changes
from stickslip.scan.code import code
from stickslip.scan.judge import JOB_ROWS
from stickslip.scan.loop_map import read_map
from stickslip.scan.result import SCHEMA, ScanResult
from stickslip.scan.sources import Source, source_of
from stickslip.scan.table import ranked, table_of
from stickslip.scan.valves import with_valves
from stickslip.scan.workers import on_cluster, on_cores

if TYPE_CHECKING:
    import polars as pl

__all__ = ["KEPT", "ScanError", "scan"]

PHRASES = {"code": "stickslip itself has changed since", "identity": "the files have changed"}

Tell = Callable[[int, int], None]


class ScanError(ValueError):
    """A scan cannot be done as asked."""


def _differences(wanted: Any, found: Any) -> list[str]:
    return differences(wanted, found, PHRASES)


KEPT = Kept("scan", SCHEMA, "order", ScanError, _differences)


def scan(
    source: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    loop_map: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    cluster: str | None = None,
    fresh: bool = False,
    tell: Tell | None = None,
) -> ScanResult:
    """Judge every loop of a source and rank them.

    Parameters: ``source`` (path or str) A folder, a Parquet or text file, or ``duckdb:SELECT ...``; ``out`` (path)
    Folder for the result, which also keeps what is done so that an interrupted scan goes on; ``loop_map`` (path,
    optional) CSV file that names the tags of each loop; ``workers`` (int, optional) Processes, by default one a core;
    ``cluster`` (str, optional) Address of a Dask scheduler: the jobs go there, and its machines must see the files
    under the same paths; ``fresh`` (bool) Throw away what another scan left in ``out``; ``tell`` (function (done,
    total), optional) Called with the number of loops judged.

    Returns a ScanResult. Raises ScanError if ``out`` holds another scan, and ReadError if the source holds no loop.
    """
    if workers is not None and workers < 1:
        raise ScanError(f"workers = {workers}, but at least one process is needed; leave it out to use all cores")
    folder = Path(out)
    mapped = () if loop_map is None else read_map(loop_map)
    found = source_of(source, folder / "source", mapped)
    request = {
        "source": found.name,
        "identity": dict(found.identity),
        "map": [repr(tags) for tags in mapped],
        "code": code(),
    }
    before = _last(folder)
    with opened(folder, request, KEPT, fresh or _renewed(folder, request)) as kept:
        kept.note(finished=False)
        _work(found, kept, workers, cluster, tell or (lambda done, total: None))
        tables = kept.rows()
        table = joined(tables, "order") if tables else table_of([])
        table = table.sort("rank") if "rank" in table.columns else ranked(with_valves(found, table, workers))
        kept.finish(table)
        kept.note(finished=True)
    return ScanResult(table=table, source=found.name, notes=found.notes, changes=changes(before, table))


def _renewed(folder: Path, request: Mapping[str, Any]) -> bool:
    """Whether the folder holds a finished scan of the same source from other days: this scan takes its place."""
    try:
        found = json.loads((folder / KEPT.manifest).read_text())
        last = found["request"]
        return bool(
            found["finished"] and last["source"] == request["source"] and last != json.loads(json.dumps(request))
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


def _last(folder: Path) -> pl.DataFrame | None:
    """The table that an earlier scan left, to be compared with."""
    import polars as pl

    file = folder / KEPT.table
    if not file.exists():
        return None
    try:
        return pl.read_parquet(file)
    except pl.exceptions.PolarsError:
        return None


def _work(source: Source, kept: RowsFolder, workers: int | None, cluster: str | None, tell: Tell) -> None:
    """Do the jobs of which no row is kept yet."""
    done = {int(order) // JOB_ROWS for table in kept.rows() for order in table["order"]}
    missing = [(number, job) for number, job in enumerate(source.jobs) if number not in done]
    total, judged_loops = source.count, sum(len(table) for table in kept.rows())
    tell(judged_loops, total)
    if not missing:
        return
    work = on_cores(missing, workers) if cluster is None else on_cluster(missing, cluster)
    for rows in work:
        kept.add(table_of(rows))
        judged_loops += len(rows)
        tell(min(judged_loops, total), total)
