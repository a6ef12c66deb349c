"""Reading records: a CSV, text or Parquet file, or a data frame, becomes a log, one control loop or all of them."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack

from stickslip.logs.errors import LogError, ReadError
from stickslip.logs.files.assemble import Layout, assemble, layout_of
from stickslip.logs.files.cells import with_plain_cells
from stickslip.logs.files.form import Form, checked
from stickslip.logs.files.frames import frame_kind, polars_frame
from stickslip.logs.files.heading import Heading, parse_heading
from stickslip.logs.files.influx import with_blocks_joined, with_fields_named
from stickslip.logs.files.loops import Origin, check_span, loop_of, loops_of, with_loops
from stickslip.logs.files.packed import is_workbook, unpacked
from stickslip.logs.files.size import check_cells
from stickslip.logs.files.source import decoded, file_bytes, is_parquet
from stickslip.logs.files.table import Table, names_and_units, parse_table
from stickslip.logs.files.workbook import sheets_of
from stickslip.logs.log import Log
from stickslip.logs.loop import LoopRecord
from stickslip.logs.tags import Process

if TYPE_CHECKING:
    import polars as pl

__all__ = ["ReadError", "read_log", "read_loop", "read_loops"]

# A path, or a frame of any library: frames are known by what they can do, so no type names them all.
Source: TypeAlias = Any

_TOP_CHARACTERS = 200_000  # characters in which a comment is looked for


def read_log(
    source: Source,
    *,
    columns: Mapping[str, str] | None = None,
    **form: Unpack[Form],
) -> Log:
    """Read a CSV, text or Parquet file, or a data frame, as a log.

    Parameters: ``source`` (path or data frame) The file; Parquet is recognised by its content. Or a frame of
    pandas, polars, pyarrow or any library that speaks Arrow; an index of pandas that is not just a count of the rows
    becomes a column; ``columns`` (mapping, optional) Name in the log -> column (or tag of a long table) in the file;
    only these are read. Otherwise every column with numbers is read under its own name; ``time`` (str, optional) Column
    of the time; ``decimal``, ``separator`` (str, optional) Decimal mark and the character between cells, found from the
    file when not given; ``time_format`` (str, optional) strptime format of the time stamps; ``interval`` (float,
    optional) Seconds between rows [s], for files without a usable time; ``time_unit`` ({"s", "ms", "us", "ns", "min",
    "h", "d", "filetime", "datenum", "excel", "labview", "ticks"}, optional) Unit of a time of numbers; otherwise found
    from its name, its size or its interval, and noted. "filetime" is 100 ns since 1601, "ticks" 100 ns since the year
    1, "datenum" MATLAB's days, "excel" a spreadsheet's days, "labview" seconds since 1904; "s" to "ns" may count from
    1970.

    Returns a Log whose notes say what was assumed, and whose ``loops`` are those that the file notes or its tags tell,
    with the spans of their outputs. A clock time becomes seconds from the first row and ``start``.

    Raises ReadError if the file cannot be read as a table of signals over time.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "trend.csv"
    >>> _ = file.write_text("time;FIC211.PV;FIC211.OP\\ns;m3/h;%\\n0;4,0;50\\n1;Bad Input;51\\n")
    >>> log = read_log(file)
    >>> log.names, log.units["FIC211.PV"], log.good("FIC211.PV").tolist()
    (('FIC211.PV', 'FIC211.OP'), 'm3/h', [True, False])
    """
    form = checked(form)
    with _named(source):
        layout = _opened(source, form)
        log = _origin(source, layout.heading).on(assemble(layout, columns))
        return log if columns else with_loops(log, layout)


def read_loop(
    source: Source,
    *,
    sp: str | None = None,
    pv: str | None = None,
    op: str | None = None,
    mv: str | None = None,
    mode: str | None = None,
    loop: str | None = None,
    name: str | None = None,
    process: Process | None = None,
    op_span: tuple[float, float] | None = None,
    **form: Unpack[Form],
) -> LoopRecord:
    """Read one control loop from a CSV, text or Parquet file, or from a data frame.

    Parameters: ``source`` (path or data frame) As for ``read_log``; ``sp``, ``pv``, ``op``, ``mv``, ``mode`` (str,
    optional) Columns (or tags) of the signals; guessed from their names when not given, "" leaves one out; ``loop``
    (str, optional) Tag of the loop, for a file with several; ``name`` (str, optional) Name to give the loop; otherwise
    its tag, or the name of the file (of a frame: "loop"); ``process`` ({"self_regulating", "integrating", "unknown"},
    optional) Otherwise taken from the first letter of the tag: levels integrate; ``op_span`` ((low, high), optional)
    Span of OP in its unit; otherwise taken from its unit or its values; ``time``, ``decimal``, ``separator``,
    ``time_format``, ``interval``, ``time_unit`` As for ``read_log``.

    Returns a LoopRecord whose signals are called SP, PV, OP, MV and MODE and whose notes say what was assumed.

    Raises ReadError as ``read_log`` does, and if the loop cannot be identified.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "trend.csv"
    >>> _ = file.write_text("time,LIC7.SP,LIC7.PV,LIC7.OP\\n0,40,41,55.5\\n10,40,42,55\\n20,40,42,54.5\\n")
    >>> record = read_loop(file)
    >>> record.name, record.measurement, record.process, record.op_percent
    ('LIC7', 'level', 'integrating', array([55.5, 55. , 54.5]))
    """
    form = checked(form)
    with _named(source):
        if op_span is not None:
            check_span(op_span)
        layout = _opened(source, form)
        given = {"sp": sp, "pv": pv, "op": op, "mv": mv, "mode": mode}
        return loop_of(layout, _origin(source, layout.heading), given, loop, name, process, op_span)


def read_loops(
    source: Source,
    *,
    loops: Sequence[str] | None = None,
    process: Process | None = None,
    **form: Unpack[Form],
) -> tuple[LoopRecord, ...]:
    """Read every control loop of a CSV, text or Parquet file, or of a data frame, in one read.

    Parameters: ``source``, ``time``, ``decimal``, ``separator``, ``time_format``, ``interval``, ``time_unit`` as for
    ``read_log``; ``loops`` the tags of the loops to read, in this order, otherwise all that the file itself notes (a
    log written by this package does) or whose names show a PV and an output, as they stand; ``process`` as for
    ``read_loop``, of every loop.

    Returns one LoopRecord a loop, each as ``read_loop(source, loop=tag)`` gives it, but without a note on the columns
    of the other loops. A file without loop tags gives the one loop that ``read_loop`` finds.

    Raises ReadError as ``read_loop`` does.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "unit.csv"
    >>> _ = file.write_text("time,FIC1.PV,FIC1.OP,LIC2.PV,LIC2.OP\\n0,4,50,1,20\\n1,5,51,2,21\\n")
    >>> [(record.name, record.process) for record in read_loops(file)]
    [('FIC1', 'self_regulating'), ('LIC2', 'integrating')]
    """
    form = checked(form)
    with _named(source):
        layout = _opened(source, form)
        origin = _origin(source, layout.heading)
        noted = layout.heading.loops if layout.heading is not None else {}
        found = (tuple(noted) or layout.columns.loops) if loops is None else tuple(loops)
        if len(found) == 0 and loops is not None:
            raise ReadError("loops names no loop; leave it out to read all, or name at least one")
        if loops is None and len(found) < 2:
            return (loop_of(layout, origin, process=process),)
        return loops_of(layout, origin, found, process)


@contextmanager
def _named(source: Source) -> Iterator[None]:
    """Put the file's name in front of a complaint."""
    kind = frame_kind(source)
    if not kind and not isinstance(source, str | os.PathLike):
        raise ReadError(
            f"{type(source).__name__} is neither a path nor a data frame; "
            "give one of these, or build a LoopRecord.from_arrays"
        )
    try:
        yield
    except (ReadError, LogError) as fault:
        raise ReadError(f"{f'{kind} frame' if kind else os.fspath(source)}: {fault}") from None


def _opened(source: Source, form: Form) -> Layout:
    if frame_kind(source):
        return layout_of(_typed(polars_frame(source)), None, form)
    raw, notes = unpacked(file_bytes(source))
    if is_parquet(raw):
        table, heading = _parquet(raw)
        return layout_of(replace(table, notes=(*notes, *table.notes)), heading, form)
    if is_workbook(raw):
        return _of_workbook(raw, form, notes)
    text = with_blocks_joined(decoded(raw))
    del raw
    return _of_text(text, form.get("separator"), form, notes)


def _of_workbook(raw: bytes, form: Form, notes: tuple[str, ...]) -> Layout:
    """The first sheet that reads as a table with a time: a sheet of words may stand before it."""
    faults = []
    for name, text, found in sheets_of(raw):
        try:
            return _of_text(text, ",", form, (*notes, *found))
        except ReadError as fault:
            faults.append(f"sheet {name!r}: {fault}")
    raise ReadError("; ".join(faults[:5]))


def _of_text(text: str, separator: str | None, form: Form, notes: tuple[str, ...]) -> Layout:
    heading = parse_heading(_comments(text))
    table = parse_table(text, separator, split_units=heading is None)
    if heading is not None:  # the time column of our own files says its unit
        first = table.frame.columns[0]
        table = replace(table, frame=table.frame.rename({first: "time"}), units={"time": "s"})
    else:
        table = with_plain_cells(with_fields_named(table))
    return layout_of(replace(table, notes=(*notes, *table.notes)), heading, form)


def _comments(text: str) -> list[str]:
    """The comment lines on top, however many, and those not far below it."""
    end = 0
    while text.startswith("#", end) and end < len(text):
        end = text.find("\n", end) + 1 or len(text)
    return [line[1:].strip() for line in text[: max(end, _TOP_CHARACTERS)].split("\n") if line.startswith("#")]


def _parquet(raw: bytes) -> tuple[Table, Heading | None]:
    import polars as pl

    try:
        found = pl.scan_parquet(io.BytesIO(raw))
        check_cells(found.select(pl.len()).collect().item(), len(found.collect_schema()))
        frame = pl.read_parquet(io.BytesIO(raw))
        text = pl.read_parquet_metadata(io.BytesIO(raw)).get("stickslip", "")
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as fault:
        raise ReadError(f"the Parquet file is damaged ({fault}); export it again") from None
    if frame.width < 2:
        raise ReadError(f"the file has only {frame.width} column; a record needs a time and a signal")
    heading = parse_heading(text.split("\n"))
    if heading is None:
        return _typed(frame), None
    frame = frame.rename({frame.columns[0]: "time"})
    return Table(frame, list(range(1, frame.height + 1)), {"time": "s"}), heading


def _typed(frame: pl.DataFrame) -> Table:
    """The table in a frame whose columns have types; units are in their names, as in a file of text.

    Words are text however they are kept: as a dictionary (a category), as bytes, or none at all in a column of nulls.
    """
    import polars as pl

    words = (pl.Null, pl.Categorical, pl.Enum, pl.Binary)
    names, units = names_and_units(frame.columns)
    frame = pl.DataFrame(
        [
            column.cast(pl.String, strict=False).str.strip_chars()
            if column.dtype in words or column.dtype == pl.String
            else column
            for column in frame.get_columns()
        ]
    )
    frame.columns = names
    return with_plain_cells(with_fields_named(Table(frame, list(range(1, frame.height + 1)), units)))


def _origin(source: Source, heading: Heading | None) -> Origin:
    kind = frame_kind(source)
    if heading is not None:
        text, notes = heading.origin, tuple(heading.notes)
    else:
        text, notes = f"read from {f'a {kind} frame' if kind else Path(source).name}", ()
    return Origin(text, notes, own=heading is not None, stem="" if kind else Path(source).stem)
