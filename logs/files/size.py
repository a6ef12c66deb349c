"""How large a table may be: one that takes more memory than a computer has is refused before it is read."""

from __future__ import annotations

from stickslip.logs.errors import ReadError

__all__ = ["CELLS_MAX", "COLUMNS_MAX", "TEXT_MAX", "check_cells", "check_columns", "check_text"]

TEXT_MAX = 300_000_000  # bytes; six million rows of three signals, which take 4 GB of memory while they are read
CELLS_MAX = 100_000_000  # numbers; a year of three signals at 1 s, 0.8 GB
COLUMNS_MAX = 100_000


def check_text(size: int) -> None:
    """Raise ReadError if a text of ``size`` bytes is too large."""
    if size > TEXT_MAX:
        raise ReadError(
            f"the text is {size / 1e6:.0f} MB, and at most {TEXT_MAX / 1e6:.0f} MB are read at once; cut it into "
            "parts, or save it as Parquet"
        )


def check_cells(rows: int, columns: int, what: str = "columns") -> None:
    """Raise ReadError if a table of numbers is too large.

    >>> check_cells(10**9, 3)
    Traceback (most recent call last):
    ...
    stickslip.logs.errors.ReadError: the table has 1000000000 rows of 3 columns, ... read it in parts, or fewer columns
    at once
    """
    if rows * columns > CELLS_MAX:
        raise ReadError(
            f"the table has {rows} rows of {columns} {what}, and at most {CELLS_MAX:.0e} numbers are held at once; "
            f"read it in parts, or fewer {what} at once"
        )


def check_columns(count: int) -> None:
    """Raise ReadError if a table has too many columns."""
    if count > COLUMNS_MAX:
        raise ReadError(
            f"the header has {count} columns, and at most {COLUMNS_MAX} are read; look at the separator "
            "(--separator), or export fewer tags at once"
        )
