"""Reading records: a CSV, text or Parquet file, or a data frame, becomes a log or one control loop."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from logs.errors import LogError, ReadError
from logs.files.assemble import Layout, assemble, layout_of
from logs.files.columns import Roles, choose_columns
from logs.files.frames import frame_kind, polars_frame
from logs.files.heading import Heading, parse_heading
from logs.files.source import decoded, file_bytes, is_parquet
from logs.files.table import Table, names_and_units, parse_table
from logs.log import Log
from logs.loop import LoopRecord
from logs.spans import guess_op_span
from logs.tags import Process, measurement_of, process_of, tag_in

if TYPE_CHECKING:
    import polars as pl

__all__ = ["ReadError", "read_log", "read_loop"]

_UNUSED_SHOWN = 15
# A path, or a frame of any library: frames are known by what they can do, so no type names them all.
Source: TypeAlias = Any


def read_log(
    source: Source,
    *,
    columns: Mapping[str, str] | None = None,
    time: str | None = None,
    decimal: str | None = None,
    separator: str | None = None,
    time_format: str | None = None,
    interval: float | None = None,
    time_unit: str | None = None,
) -> Log:
    """Read a CSV, text or Parquet file, or a data frame, as a log.

    Parameters: ``source`` (path or data frame) The file; Parquet is told by its content, not by its name. Or a frame of
    pandas, polars, pyarrow or any library that speaks Arrow; an index of pandas that is not just a count of the rows
    becomes a column; ``columns`` (mapping, optional) Name in the log -> column (or tag of a long table) in the file;
    only these are read. Otherwise every column with numbers is read under its own name; ``time`` (str, optional) Column
    of the time; ``decimal``, ``separator`` (str, optional) Decimal mark and the character between cells, found from the
    file when not given; ``time_format`` (str, optional) strptime format of the time stamps; ``interval`` (float,
    optional) Seconds between rows [s], for files without a usable time; ``time_unit`` ({"s", "ms", "us", "ns", "min",
    "h", "d", "filetime", "datenum", "excel", "labview", "ticks"}, optional) Unit of a time of numbers; otherwise told
    from its name, its size or its interval, and noted. "filetime" is 100 ns since 1601, "ticks" 100 ns since the year
    1, "datenum" MATLAB's days, "excel" a spreadsheet's days, "labview" seconds since 1904; "s" to "ns" may count from
    1970.

    Returns a Log whose notes say what was assumed. A clock time becomes seconds from the first row and ``start``.

    Raises ReadError if the file cannot be read as a table of signals over time.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "trend.csv"
    >>> _ = file.write_text("time;FIC211.PV;FIC211.OP\\ns;m3/h;%\\n0;4,0;50\\n1;Bad Input;51\\n")
    >>> log = read_log(file)
    >>> log.names, log.units["FIC211.PV"], log.good("FIC211.PV").tolist()
    (('FIC211.PV', 'FIC211.OP'), 'm3/h', [True, False])
    """
    with _named(source):
        table, heading = _opened(source, separator)
        layout = layout_of(table, heading, time, decimal, time_format, interval, time_unit)
        return _with_origin(assemble(layout, columns), source, heading)


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
    time: str | None = None,
    decimal: str | None = None,
    separator: str | None = None,
    time_format: str | None = None,
    interval: float | None = None,
    time_unit: str | None = None,
) -> LoopRecord:
    """Read one control loop from a CSV, text or Parquet file, or from a data frame.

    Parameters: ``source`` (path or data frame) As for ``read_log``; ``sp``, ``pv``, ``op``, ``mv``, ``mode`` (str,
    optional) Columns (or tags) of the signals; guessed from their names when not given, "" leaves one out; ``loop``
    (str, optional) Tag of the loop, for a file with several; ``name`` (str, optional) Name to give the loop; otherwise
    its tag, or the name of the file (of a frame: "loop"); ``process`` ({"self_regulating", "integrating", "unknown"},
    optional) Otherwise told from the first letter of the tag: levels integrate; ``op_span`` ((low, high), optional)
    Span of OP in its unit; otherwise told from its unit or its values; ``time``, ``decimal``, ``separator``,
    ``time_format``, ``interval``, ``time_unit`` As for ``read_log``.

    Returns a LoopRecord whose signals are called SP, PV, OP, MV and MODE and whose notes say what was assumed.

    Raises ReadError as ``read_log`` does, and if the loop cannot be told.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "trend.csv"
    >>> _ = file.write_text("time,LIC7.SP,LIC7.PV,LIC7.OP\\n0,40,41,55.5\\n10,40,42,55\\n20,40,42,54.5\\n")
    >>> record = read_loop(file)
    >>> record.name, record.measurement, record.process, record.op_percent
    ('LIC7', 'level', 'integrating', array([55.5, 55. , 54.5]))
    """
    with _named(source):
        if op_span is not None:
            _check_span(op_span)
        table, heading = _opened(source, separator)
        layout = layout_of(table, heading, time, decimal, time_format, interval, time_unit)
        given = {"sp": sp, "pv": pv, "op": op, "mv": mv, "mode": mode}
        roles = choose_columns(layout.names, given, loop)
        parts = {"SP": roles.sp, "PV": roles.pv, "OP": roles.op, "MV": roles.mv, "MODE": roles.mode}
        wanted = {part: column for part, column in parts.items() if column is not None}
        log = assemble(layout, wanted, [roles.mode] if roles.mode else [])
        log = _with_origin(log, source, heading)
        notes = [f"{c!r} is read as {part}." for part, c in wanted.items() if _differs(c, part, roles.loop)]
        notes += roles.notes
        notes += _about_unused(layout, roles)
        if "MODE" in log and not np.isfinite(log["MODE"]).any():
            log = _without(log, "MODE")
        log, found = _with_spans(log, op_span, own=heading is not None)
        notes += found
        stem = "" if frame_kind(source) else Path(source).stem
        tag = roles.loop or tag_in(stem)
        measurement = measurement_of(tag) or measurement_of(roles.pv)
        if process is None:
            process = process_of(measurement)
            notes.append(_about_process(measurement, tag, process))
        return LoopRecord(
            log=replace(log, notes=(*log.notes, *(note for note in notes if note not in log.notes))),
            name=name or roles.loop or stem or "loop",
            sp_name="SP" if "SP" in log else None,
            pv_name="PV",
            op_name="OP",
            mv_name="MV" if "MV" in log else None,
            mode_name="MODE" if "MODE" in log else None,
            process=process,
            measurement=measurement,
        )


def _about_unused(layout: Layout, roles: Roles) -> list[str]:
    """The sentence that names the columns (or tags) that are not used, each with the reason."""
    reasons = {**layout.aside, **dict(roles.unused)}
    taken = {roles.pv, roles.op, roles.sp, roles.mv, roles.mode}
    for column, signals in layout.marks.items():
        if not taken & set(signals):
            reasons[column] = f"quality of {signals[0]!r}"
    if not reasons or layout.heading is not None:
        return []
    shown = [f"{column!r} ({why})" for column, why in list(reasons.items())[:_UNUSED_SHOWN]]
    more = len(reasons) - len(shown)
    rest = f" and {more} more" if more else ""
    return [f"Columns not used: {', '.join(shown)}{rest}."]


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


def _opened(source: Source, separator: str | None) -> tuple[Table, Heading | None]:
    if frame_kind(source):
        return _typed(polars_frame(source)), None
    raw = file_bytes(source)
    if is_parquet(raw):
        return _parquet(raw)
    text = decoded(raw)
    head = [line[1:].strip() for line in text[:200_000].split("\n") if line.startswith("#")]
    heading = parse_heading(head)
    table = parse_table(text, separator, split_units=heading is None)
    if heading is not None:  # the time column of our own files says its unit
        first = table.frame.columns[0]
        table = replace(table, frame=table.frame.rename({first: "time"}), units={"time": "s"})
    return table, heading


def _parquet(raw: bytes) -> tuple[Table, Heading | None]:
    import polars as pl

    try:
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
    """The table in a frame whose columns have types; units are in their names, as in a file of text."""
    names, units = names_and_units(frame.columns)
    frame = frame.rename(dict(zip(frame.columns, names, strict=True)))
    return Table(frame, list(range(1, frame.height + 1)), units)


def _with_origin(log: Log, source: Source, heading: Heading | None) -> Log:
    if heading is not None:
        return replace(log, origin=heading.origin, notes=(*heading.notes, *log.notes))
    kind = frame_kind(source)
    return replace(log, origin=f"read from {f'a {kind} frame' if kind else Path(source).name}")


def _differs(column: str, part: str, loop: str) -> bool:
    """Whether the reader had to interpret: FIC211.PV of the loop FIC211 is plain, PID1/OUT.CV is not."""
    rest = column.casefold().replace(loop.casefold(), "", 1) if loop else column.casefold()
    return rest.strip(" ._/\\:-") != part.casefold()


def _without(log: Log, name: str) -> Log:
    return replace(
        log,
        signals={key: values for key, values in log.signals.items() if key != name},
        units={key: unit for key, unit in log.units.items() if key != name},
        spans={key: span for key, span in log.spans.items() if key != name},
        quality={key: mask for key, mask in log.quality.items() if key != name},
    )


def _check_span(span: tuple[float, float]) -> None:
    low, high = (float(limit) for limit in span)
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise ReadError(
            f"op_span = ({low:g}, {high:g}) is empty or turned round; give finite low < high, "
            "and turn the signal itself for an air-to-close valve"
        )


def _with_spans(log: Log, op_span: tuple[float, float] | None, *, own: bool) -> tuple[Log, list[str]]:
    """The log with the span of OP, and that of MV where it moves on the same scale."""
    notes: list[str] = []
    unit = log.units.get("OP", "")
    span: tuple[float, float] | None
    if op_span is not None:
        span = (float(op_span[0]), float(op_span[1]))
    elif own or "OP" in log.spans:
        return log, notes
    else:
        span, unit, note = guess_op_span(log["OP"][log.good("OP")], unit)
        notes += [note] if note else []
    if span is None:
        return log, notes
    units = dict(log.units) | ({"OP": unit} if unit else {})
    spans = dict(log.spans) | {"OP": span}
    if "MV" in log and "MV" not in spans and units.get("MV", unit) == unit:
        seen = log["MV"][log.good("MV")]
        margin = 0.05 * (span[1] - span[0])
        if len(seen) and span[0] - margin <= seen.min() and seen.max() <= span[1] + margin:
            spans["MV"] = span
            units |= {"MV": unit} if unit else {}
    return replace(log, units=units, spans=spans), notes


def _about_process(measurement: str, tag: str, process: str) -> str:
    if not measurement:
        return "The tag does not tell what is measured: the process is taken as unknown."
    kind = "integrating" if process == "integrating" else "self-regulating"
    return f"The process is taken as {kind}: {tag or 'the tag of PV'} is a {measurement} loop."
