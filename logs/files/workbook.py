"""The sheets of an Excel workbook as lines of text, so that each is read as any other table."""

from __future__ import annotations

import csv
import io
import re
import zipfile
import zlib
from collections.abc import Iterator
from datetime import date, datetime, time, timedelta
from typing import IO, Any

from stickslip.logs.errors import ReadError

__all__ = ["sheets_of"]

_ZERO = datetime(1899, 12, 30)  # day 0 of a spreadsheet
_CELL = re.compile(rb"""\br\s*=\s*["']\$?([A-Za-z]+)\$?(\d+)["']""")
_CHUNK, _OVERLAP = 1 << 20, 64  # bytes of a sheet looked at once, and those looked at again
_COLUMNS, _ROWS = 16_384, 1_048_576  # of a sheet
_AREA = 50_000_000  # cells; the reader holds every one between the first and the last, empty or not


def sheets_of(raw: bytes) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Every sheet with at least two columns and two rows: its name, its text, and notes on what is taken.

    Between the cells stands a comma.

    Parameters: ``raw`` (bytes) The workbook (.xlsx, .xlsm).

    Raises ReadError if the reader of workbooks is not installed, the workbook is damaged, or no sheet holds a table.
    """
    try:
        from python_calamine import CalamineError, CalamineWorkbook
    except ImportError:
        raise ReadError(
            "this is an Excel workbook (.xlsx), and its reader is not installed: pip install 'stickslip[excel]', "
            "or save the sheet as CSV and read that"
        ) from None
    _check_extent(raw)
    try:
        book = CalamineWorkbook.from_filelike(io.BytesIO(raw))
        names = list(book.sheet_names)
        found = False
        for name in names:
            rows = book.get_sheet_by_name(name).to_python()
            if len(rows) > 1 and max(map(len, rows)) > 1:
                left = [other for other in names if other != name]
                notes = [f"Read from the sheet {name!r} of the workbook."]
                if left:
                    notes.append(f"Other sheets are passed over: {', '.join(map(repr, left[:5]))}.")
                found = True
                yield name, _lines(rows), tuple(notes)
    except (CalamineError, OSError, ValueError) as fault:
        raise ReadError(
            f"the Excel workbook (.xlsx) is damaged or locked ({fault}); save the sheet as CSV and read that"
        ) from None
    if not found:
        raise ReadError(f"no sheet of the workbook holds a table ({', '.join(map(repr, names[:5]))}); export it again")


def _check_extent(raw: bytes) -> None:
    """Raise ReadError for a sheet whose cells lie so far apart that its reader would take all memory."""
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            for name in archive.namelist():
                if name.startswith("xl/worksheets/") and name.endswith(".xml"):
                    with archive.open(name) as stream:
                        columns, rows = _extent(stream)
                    if columns > _COLUMNS or rows > _ROWS or columns * rows > _AREA:
                        raise ReadError(
                            f"a sheet of the workbook ({name}) has cells over {columns} columns and {rows} rows, more "
                            "than is read; delete what stands beside and below the table, or save it as CSV"
                        )
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, zlib.error) as fault:
        raise ReadError(f"the Excel workbook (.xlsx) is damaged or locked ({fault}); save the sheet as CSV") from None


def _extent(stream: IO[bytes]) -> tuple[int, int]:
    """The last column and the last row that a cell of a sheet names."""
    columns: set[bytes] = set()
    last, before = 0, b""
    while chunk := stream.read(_CHUNK):
        found = _CELL.findall(before + chunk)
        columns.update(column.upper()[:8] for column, _ in found)
        last = max(last, max((int(row[:12]) for _, row in found), default=0))
        before = chunk[-_OVERLAP:]
    return max(map(_number, columns), default=0), last


def _number(column: bytes) -> int:
    """A column's letters as a number: A is 1, Z 26, AA 27."""
    value = 0
    for letter in column:
        value = 26 * value + letter - 64
    return value


def _lines(rows: list[list[Any]]) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for row in rows:
        writer.writerow([_cell(value) for value in row])
    return out.getvalue()


def _cell(value: Any) -> str:
    if isinstance(value, datetime):
        return value.isoformat(sep=" ", timespec="milliseconds")
    if isinstance(value, timedelta):  # a clock time with a day number is one number to a workbook
        return (_ZERO + value).isoformat(sep=" ", timespec="milliseconds")
    if isinstance(value, date | time):
        return value.isoformat()
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return str(value).replace("\r", "\n")
