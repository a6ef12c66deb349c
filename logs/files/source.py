"""From a path to text: what kind of file it is, and which encoding it is in."""

from __future__ import annotations

import codecs
import os
from pathlib import Path

from stickslip.logs.errors import ReadError
from stickslip.logs.files.encodings import encoding_of
from stickslip.logs.files.size import check_text

__all__ = ["decoded", "file_bytes", "is_parquet"]

_EXPORT = "export the data as CSV (or Parquet) and read that"
_MAGIC = (
    (b"\xd0\xcf\x11\xe0", "an old Excel workbook (.xls)"),
    (b"7z\xbc\xaf", "a 7z archive"),
    (b"\x89HDF", "an HDF5 file"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"%PDF", "a PDF document"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"SQLite format 3", "an SQLite data base"),
    (b"TDSm", "a LabVIEW TDMS file"),
)


def is_parquet(raw: bytes) -> bool:
    """Whether the bytes start as a Parquet file does."""
    return raw[:4] == b"PAR1"


def file_bytes(path: str | os.PathLike[str]) -> bytes:
    """The bytes of the file. Raises ReadError if there is none, it is a folder, unreadable, empty or too large."""
    try:
        with Path(path).open("rb") as stream:
            if not is_parquet(stream.read(4)):  # Parquet says itself how large it is
                check_text(os.fstat(stream.fileno()).st_size)
        raw = Path(path).read_bytes()
    except FileNotFoundError:
        raise ReadError("no such file; check the path and the name") from None
    except IsADirectoryError:
        raise ReadError("this is a folder; name one file in it") from None
    except PermissionError:
        raise ReadError("permission denied; ask for the right to read it or copy it elsewhere") from None
    except (OSError, ValueError) as fault:
        raise ReadError(f"cannot be opened ({fault}); check the path") from None
    if not raw:
        raise ReadError("the file is empty (0 bytes); export it again")
    return raw


def decoded(raw: bytes) -> str:
    """Return ``raw`` as text: UTF-8, UTF-16 with its mark, else GBK, Shift-JIS or Windows-1252; line ends become "\\n".

    Raises ReadError for workbooks, archives, pictures, web pages and other files that are not tables of text.

    >>> decoded(b"time,PV\\r0,1\\r")
    'time,PV\\n0,1\\n'
    """
    _refuse_known_formats(raw)
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        text = _decode(raw, "utf-16")
    else:
        if b"\0" in raw:
            raise ReadError(
                "the file holds zero bytes, so it is binary or UTF-16 without its mark; "
                "save it as UTF-8 text or " + _EXPORT
            )
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = _decode(raw, encoding_of(raw))
    odd = sum(text[:4000].count(chr(code)) for code in range(32) if chr(code) not in "\t\n\v\f\r\x1a")
    if odd > 4:
        raise ReadError("the file holds control characters, so it is binary; " + _EXPORT)
    return text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\x1a")


def _decode(raw: bytes, encoding: str) -> str:
    try:
        return raw.decode(encoding)
    except UnicodeDecodeError as fault:
        raise ReadError(
            f"byte {fault.start} (0x{raw[fault.start]:02x}) fits neither UTF-8 nor {encoding}; "
            "save the file as UTF-8 text"
        ) from None


def _refuse_known_formats(raw: bytes) -> None:
    for magic, kind in _MAGIC:
        if raw.startswith(magic):
            raise ReadError(f"this is {kind}, not a table of text; {_EXPORT}")
    start = raw[:200].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    if start.startswith((b"<!doctype", b"<html", b"<?xml")):
        raise ReadError(f"this is a web page or XML, not a table of text; {_EXPORT}")
    if start.startswith((b"{", b"[{")):
        raise ReadError(f"this is JSON, not a table of text; {_EXPORT}")
