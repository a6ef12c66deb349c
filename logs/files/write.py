"""Writing a log: to a temporary file beside the target, then renamed, so no reader sees half a file."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.logs.files.heading import Heading, heading_of
from stickslip.logs.signals import Signals

if TYPE_CHECKING:
    import polars as pl

__all__ = ["replacing", "write_csv", "write_parquet"]

TIME_COLUMN = "time [s]"


def write_csv(log: Signals, path: str | os.PathLike[str]) -> None:
    """Write ``log`` as UTF-8 CSV: '# ' heading lines, a header row, one row a sample, missing values empty.

    Numbers are written with as many digits as it takes to read back the same double. Raises OSError when
    the target cannot be written; the file there before is then untouched.
    """
    heading = heading_of(log)
    text = "".join(f"# {line}\n" for line in heading.lines())
    with replacing(path) as part, open(part, "xb") as file:
        file.write(text.encode("utf-8"))
        _frame(log, heading, nan_to_null=True).write_csv(file, quote_style="necessary")


def write_parquet(log: Signals, path: str | os.PathLike[str]) -> None:
    """Write ``log`` as Parquet with its heading under the key "stickslip" of the footer.

    Raises OSError when the target cannot be written; the file there before is then untouched.
    """
    heading = heading_of(log)
    with replacing(path) as part:
        _frame(log, heading).write_parquet(part, metadata={"stickslip": "\n".join(heading.lines())})


def _frame(log: Signals, heading: Heading, *, nan_to_null: bool = False) -> pl.DataFrame:
    import polars as pl

    columns = {TIME_COLUMN: pl.Series(TIME_COLUMN, log.t)}
    for name in log.names:
        columns[name] = pl.Series(name, log[name], nan_to_null=nan_to_null)
    for name, column in heading.quality.items():
        columns[column] = pl.Series(column, log.quality[name].astype("int8"))
    return pl.DataFrame(columns)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a new file beside ``path`` to write to, and rename it into place when all went well.

    A link keeps pointing where it did. Raises OSError naming ``path`` when it is a folder, a device or a pipe (renaming
    would destroy it), or cannot be written; what was there before is then untouched.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "this is a folder; name a file in it", str(path))
    if target.exists() and not target.is_file():
        raise OSError(errno.EINVAL, "this is a device or a pipe; name an ordinary file", str(path))
    if not target.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder '{target.parent}'; make it first", str(path))
    part = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield part
        os.replace(part, target)
    except OSError as fault:  # names the part, which nobody asked for; polars gives neither number nor name
        raise type(fault)(fault.errno or errno.EIO, fault.strerror or str(fault), str(path)) from None
    finally:
        part.unlink(missing_ok=True)
