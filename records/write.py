"""Writing a log: to a temporary file beside the target, then renamed, so no reader sees half a file."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from records.heading import Heading, heading_of
from records.log import Log

if TYPE_CHECKING:
    import polars as pl

__all__ = ["write_csv", "write_parquet"]

TIME_COLUMN = "time [s]"


def write_csv(log: Log, path: str | os.PathLike[str]) -> None:
    """Write `log` as UTF-8 CSV: '# ' heading lines, a header row, one row a sample, missing values empty.

    Numbers are written with as many digits as it takes to read back the same double. Raises OSError when
    the target cannot be written; the file there before is then untouched.
    """
    heading = heading_of(log)
    text = "".join(f"# {line}\n" for line in heading.lines())
    with _replacing(path) as part, open(part, "xb") as file:
        file.write(text.encode("utf-8"))
        _frame(log, heading).fill_nan(None).write_csv(file, quote_style="necessary")


def write_parquet(log: Log, path: str | os.PathLike[str]) -> None:
    """Write `log` as Parquet with its heading under the key "stickslip" of the footer.

    Raises OSError when the target cannot be written; the file there before is then untouched.
    """
    heading = heading_of(log)
    with _replacing(path) as part:
        _frame(log, heading).write_parquet(part, metadata={"stickslip": "\n".join(heading.lines())})


def _frame(log: Log, heading: Heading) -> pl.DataFrame:
    import polars as pl

    columns = {TIME_COLUMN: pl.Series(TIME_COLUMN, log.t)}
    for name in log.names:
        columns[name] = pl.Series(name, log[name])
    for name, column in heading.quality.items():
        columns[column] = pl.Series(column, log.quality[name].astype("int8"))
    return pl.DataFrame(columns)


@contextmanager
def _replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    target = Path(path)
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
        os.replace(part, target)
    finally:
        part.unlink(missing_ok=True)
