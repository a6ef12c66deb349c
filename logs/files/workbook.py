"""A sheet of an Excel workbook as lines of text, so that it is read as any other table."""

from __future__ import annotations

import csv
import io
from datetime import date, datetime, time, timedelta
from typing import Any

from logs.errors import ReadError

__all__ = ["workbook_text"]

_ZERO = datetime(1899, 12, 30)  # day 0 of a spreadsheet


def workbook_text(raw: bytes) -> tuple[str, tuple[str, ...]]:
    """The first sheet with at least two columns and two rows, comma between the cells, and notes on what was taken.

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
    try:
        book = CalamineWorkbook.from_filelike(io.BytesIO(raw))
        names = list(book.sheet_names)
        for name in names:
            rows = book.get_sheet_by_name(name).to_python()
            if len(rows) > 1 and max(map(len, rows)) > 1:
                left = [other for other in names if other != name]
                notes = [f"Read from the sheet {name!r} of the workbook."]
                if left:
                    notes.append(f"Other sheets are passed over: {', '.join(map(repr, left[:5]))}.")
                return _lines(rows), tuple(notes)
    except (CalamineError, OSError, ValueError) as fault:
        raise ReadError(
            f"the Excel workbook (.xlsx) is damaged or locked ({fault}); save the sheet as CSV and read that"
        ) from None
    raise ReadError(f"no sheet of the workbook holds a table ({', '.join(map(repr, names[:5]))}); export it again")


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
