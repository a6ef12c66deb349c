"""One file inside a gzip or zip archive, unpacked without ever holding more than ``UNPACKED_MAX`` bytes."""

from __future__ import annotations

import gzip
import io
import zipfile
import zlib

from stickslip.logs.errors import ReadError
from stickslip.logs.files.size import TEXT_MAX

__all__ = ["UNPACKED_MAX", "is_workbook", "unpacked"]

UNPACKED_MAX = TEXT_MAX
_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"
_NOTHING = b"PK\x05\x06"  # a zip archive of no file begins with its end
_ASIDE = ("__MACOSX/", ".DS_Store")  # what a packing program adds of its own


def is_workbook(raw: bytes) -> bool:
    """Whether the bytes are a workbook of Excel 2007 or later (.xlsx, .xlsm)."""
    if not raw.startswith(_ZIP):
        return False
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            return any(name.startswith("xl/") for name in archive.namelist())
    except zipfile.BadZipFile:
        return False


def unpacked(raw: bytes, most: int = UNPACKED_MAX) -> tuple[bytes, tuple[str, ...]]:
    """The bytes of the one file in a gzip or zip archive, and a note; other bytes as they are, without a note.

    Parameters: ``raw`` (bytes) The archive; ``most`` (int) Largest size of the file in it [bytes].

    Raises ReadError if the archive is damaged, locked, holds several files, or a file that is too large.

    >>> import gzip
    >>> unpacked(gzip.compress(b"time,PV"))
    (b'time,PV', ('Unpacked from a gzip archive.',))
    """
    if is_workbook(raw):
        _check_workbook(raw, most)
        return raw, ()
    if raw.startswith(_NOTHING):
        raise ReadError("the zip archive is empty; export it again")
    if raw.startswith(_GZIP):
        kind, content = "gzip", _gzip(raw, most)
    elif raw.startswith(_ZIP):
        kind, content = "zip", _zip(raw, most)
    else:
        return raw, ()
    if content.startswith((_GZIP, _ZIP)) and not is_workbook(content):
        raise ReadError(f"the {kind} archive holds another archive; unpack it and name the table in it")
    if not content:
        raise ReadError(f"the file in the {kind} archive is empty (0 bytes); export it again")
    return content, (f"Unpacked from a {kind} archive.",)


def _check_workbook(raw: bytes, most: int) -> None:
    """A workbook is a zip archive of its sheets; its reader unpacks them whole."""
    with zipfile.ZipFile(io.BytesIO(raw)) as archive:
        size = sum(entry.file_size for entry in archive.infolist())
    if size > most:
        raise ReadError(
            f"the workbook unpacks to {size / 1e6:.0f} MB, more than {most / 1e6:.0f} MB; save the sheet as CSV and "
            "read that"
        )


def _gzip(raw: bytes, most: int) -> bytes:
    try:
        with gzip.open(io.BytesIO(raw)) as stream:
            return _at_most(stream.read(most + 1), most, "gzip")
    except (OSError, EOFError, zlib.error) as fault:
        raise ReadError(f"the gzip archive is damaged ({fault}); export it again") from None


def _zip(raw: bytes, most: int) -> bytes:
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            files = [
                entry for entry in archive.infolist() if not entry.is_dir() and not entry.filename.startswith(_ASIDE)
            ]
            if len(files) != 1:
                shown = ", ".join(repr(entry.filename) for entry in files[:5])
                raise ReadError(f"the zip archive holds {len(files)} files ({shown}); unpack it and name one of them")
            if files[0].file_size > most:  # said by the archive itself: no need to unpack it
                raise ReadError(_too_large(most, "zip"))
            with archive.open(files[0]) as stream:
                return _at_most(stream.read(most + 1), most, "zip")
    except RuntimeError:
        raise ReadError("the zip archive is locked with a password; unpack it and name the table in it") from None
    except (zipfile.BadZipFile, NotImplementedError, EOFError, OSError, zlib.error) as fault:
        raise ReadError(f"the zip archive is damaged ({fault}); export it again") from None


def _at_most(content: bytes, most: int, kind: str) -> bytes:
    if len(content) > most:
        raise ReadError(_too_large(most, kind))
    return content


def _too_large(most: int, kind: str) -> str:
    return (
        f"the file in the {kind} archive is larger than {most / 1e6:.0f} MB; unpack it, cut it into parts, "
        "and read those"
    )
