"""Hostile files that are no plain text: archives, workbooks, Parquet, odd encodings."""

# ruff: noqa: E501  one hostile file a line

import gzip
import io
import random
import struct
import zipfile
import zlib
from collections.abc import Iterator

from benchmarks.hostile_rows import good_rows, table

__all__ = ["containers", "encodings", "parquets", "sheet_rows", "workbook", "workbooks"]


def _zipped(*contents: tuple[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents:
            archive.writestr(name, content)
    return buffer.getvalue()


def _patched(raw: bytes, old: bytes, new: bytes) -> bytes:
    assert old in raw and len(old) == len(new)
    return raw.replace(old, new)


def containers() -> Iterator[tuple[str, bytes, str]]:
    """Archives, other formats and noise: what, content, ending."""
    good = table().encode()
    packed, zipped = gzip.compress(good, mtime=0), _zipped(("FIC1.csv", good))
    yield "empty", b"", "csv"
    yield "one byte", b"0", "csv"
    for share in (0.02, 0.3, 0.6, 0.95):
        yield f"gzip cut at {share:g}", packed[: int(share * len(packed)) + 1], "csv.gz"
        yield f"zip cut at {share:g}", zipped[: int(share * len(zipped)) + 1], "zip"
    yield "gzip, wrong check sum", packed[:-8] + b"\0" * 8, "csv.gz"
    yield "gzip, rubbish behind", packed + b"rubbish", "csv.gz"
    yield "gzip of nothing", gzip.compress(b"", mtime=0), "csv.gz"
    yield "gzip in gzip", gzip.compress(packed, mtime=0), "csv.gz"
    yield "gzip bomb", gzip.compress(bytes(20_000_000), mtime=0) * 60, "csv.gz"
    yield "gzip bomb of text", gzip.compress(b"0,1,2\n" * 3_000_000, mtime=0) * 60, "csv.gz"
    yield (
        "zip bomb",
        _patched(_zipped(("FIC1.csv", bytes(2_000_000))), struct.pack("<I", 2_000_000), struct.pack("<I", 0xFFFFFFF0)),
        "zip",
    )
    yield (
        "zip that understates its size",
        _patched(_zipped(("FIC1.csv", b"0,1,2\n" * 100_000)), struct.pack("<I", 600_000), struct.pack("<I", 60)),
        "zip",
    )
    yield "zip of two files", _zipped(("a.csv", good), ("b.csv", good)), "zip"
    yield "zip of two files of one name", _zipped(("a.csv", good), ("a.csv", good)), "zip"
    yield "zip without a file", _zipped(), "zip"
    yield "zip of ten thousand files", _zipped(*((f"{i}", b"") for i in range(10_000))), "zip"
    yield "zip of a folder", _zipped(("folder/", b"")), "zip"
    yield "zip, path upwards", _zipped(("../../../../tmp/stickslip-escaped.csv", good)), "zip"
    yield "zip, path from the root", _zipped(("/tmp/stickslip-escaped.csv", good)), "zip"
    yield "zip, path of a drive", _zipped(("C:\\stickslip-escaped.csv", good)), "zip"
    yield "zip, name that is a formula", _zipped(("=cmd|' /C calc'!A0.csv", good)), "zip"
    yield "zip, name that is markup", _zipped(("<script>alert(1)</script>.csv", good)), "zip"
    yield (
        "zip, locked",
        _patched(zipped, b"PK\x03\x04\x14\0\0\0", b"PK\x03\x04\x14\0\1\0").replace(
            b"PK\1\2\x14\3\x14\0\0\0", b"PK\1\2\x14\3\x14\0\1\0"
        ),
        "zip",
    )
    yield "zip, unknown packing", zipped.replace(b"\x08\0", b"\x63\0", 2), "zip"
    yield "zip in zip", _zipped(("a.zip", zipped)), "zip"
    yield "zlib without gzip", zlib.compress(good), "csv"
    for what, magic in (
        ("old Excel", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"), ("HDF5", b"\x89HDF\r\n\x1a\n"), ("PDF", b"%PDF-1.7\n"),
        ("PNG", b"\x89PNG\r\n\x1a\n"), ("SQLite", b"SQLite format 3\0"), ("7z", b"7z\xbc\xaf\x27\x1c"),
        ("ELF", b"\x7fELF\2\1\1"), ("bzip2", b"BZh91AY&SY"), ("xz", b"\xfd7zXZ\0"), ("tar", b"a.csv" + bytes(252) + b"ustar"),
        ("zstandard", b"\x28\xb5\x2f\xfd"), ("Feather", b"ARROW1\0\0"), ("pickle", b"\x80\x05cposix\nsystem\n"),
    ):  # fmt: skip
        yield what, magic + bytes(range(256)) * 3, "csv"
    for seed in range(4):
        yield f"noise {seed}", random.Random(seed).randbytes(3000), "csv"
        yield f"noise {seed} without zeros", random.Random(seed).randbytes(3000).replace(b"\0", b"A"), "csv"


_SHEET = (
    '<?xml version="1.0"?><worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main">'
    "<sheetData>{rows}</sheetData></worksheet>"
)
_WORKBOOK = (
    '<?xml version="1.0"?>{entity}<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" '
    'xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets>'
    '<sheet name="{name}" sheetId="1" r:id="rId1"/></sheets></workbook>'
)
_RELATIONS = (
    '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" '
    'Target="{target}"/></Relationships>'
)
_OFFICE = "application/vnd.openxmlformats-officedocument"
_TYPES = (
    '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    f'<Override PartName="/xl/workbook.xml" ContentType="{_OFFICE}.spreadsheetml.sheet.main+xml"/>'
    f'<Override PartName="/xl/worksheets/sheet1.xml" ContentType="{_OFFICE}.spreadsheetml.worksheet+xml"/></Types>'
)
_ROOT = (
    '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" '
    'Target="xl/workbook.xml"/></Relationships>'
)


def workbook(rows: str, name: str = "Trend", target: str = "worksheets/sheet1.xml", entity: str = "") -> bytes:
    """A workbook of one sheet with these rows of XML."""
    return _zipped(
        ("[Content_Types].xml", _TYPES.encode()),
        ("_rels/.rels", _ROOT.encode()),
        ("xl/workbook.xml", _WORKBOOK.format(name=name, entity=entity).encode()),
        ("xl/_rels/workbook.xml.rels", _RELATIONS.format(target=target).encode()),
        ("xl/worksheets/sheet1.xml", _SHEET.format(rows=rows).encode()),
    )


def sheet_rows(cells: list[tuple[str, ...]]) -> str:
    """Rows of a sheet as XML: numbers as numbers, all else as text."""
    rows = []
    for i, row in enumerate(cells, start=1):
        parts = []
        for column, cell in zip("ABCDEFGH", row, strict=False):
            number = cell.replace(".", "", 1).lstrip("-").isdigit()
            inside = f"<v>{cell}</v>" if number else f"<is><t>{cell}</t></is>"
            parts.append(f'<c r="{column}{i}"{"" if number else " t=" + chr(34) + "inlineStr" + chr(34)}>{inside}</c>')
        rows.append(f'<row r="{i}">{"".join(parts)}</row>')
    return "".join(rows)


def workbooks() -> Iterator[tuple[str, bytes]]:
    """Workbooks of Excel: what, content."""
    rows = sheet_rows([("time", "PV", "OP"), *good_rows()])
    good = workbook(rows)
    yield "read as it is", good
    for share in (0.2, 0.5, 0.9, 0.99):
        yield f"cut at {share:g}", good[: int(share * len(good))]
    yield "a corner cell a million rows away", workbook(rows + '<row r="1048576"><c r="XFD1048576"><v>1</v></c></row>')
    yield "a cell beyond all columns", workbook(rows + '<row r="41"><c r="ZZZZZZ41"><v>1</v></c></row>')
    yield "a cell of row zero", workbook(rows + '<row r="0"><c r="A0"><v>1</v></c></row>')
    yield "a cell of row -1", workbook(rows + '<row r="-1"><c r="A-1"><v>1</v></c></row>')
    yield "a sheet that is not there", workbook(rows, target="worksheets/none.xml")
    yield "a sheet outside the archive", workbook(rows, target="../../../../etc/passwd")
    yield "a sheet from the network", workbook(rows, target="http://127.0.0.1:9/x.xml")
    yield "no sheet's rows", workbook("")
    yield "one cell", workbook('<row r="1"><c r="A1"><v>1</v></c></row>')
    yield "XML that breaks off", workbook(rows + "<row><c")
    yield "entities that grow", workbook(
        rows, name="&d;", entity='<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">'
        '<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;"><!ENTITY d "&c;&c;&c;&c;&c;&c;&c;&c;">]>',
    )  # fmt: skip
    yield (
        "an entity of a file",
        workbook(rows, name="&x;", entity='<!DOCTYPE x [<!ENTITY x SYSTEM "file:///etc/passwd">]>'),
    )
    yield (
        "errors of formulas",
        workbook(
            rows
            + '<row r="41"><c r="A41"><v>40</v></c><c r="B41" t="e"><v>#DIV/0!</v></c><c r="C41" t="e"><v>#REF!</v></c></row>'
        ),
    )
    yield "a shared text that is not there", workbook(rows + '<row r="41"><c r="A41" t="s"><v>99</v></c></row>')
    yield "a date beyond all days", workbook(rows + '<row r="41"><c r="A41" s="1" t="d"><v>99999-99-99</v></c></row>')
    yield "a sheet of spaces", workbook(" " * 30_000_000)


def parquets() -> Iterator[tuple[str, bytes]]:
    """Parquet files: what, content."""
    import polars as pl

    def packed(frame: pl.DataFrame, **more: object) -> bytes:
        out = io.BytesIO()
        frame.write_parquet(out, **more)  # type: ignore[arg-type]
        return out.getvalue()

    plain = pl.DataFrame(
        {"time": range(40), "PV": [4.0 + i % 7 for i in range(40)], "OP": [50.0 + i % 5 for i in range(40)]}
    )
    good = packed(plain)
    for share in (0.1, 0.5, 0.9, 0.999):
        yield f"cut at {share:g}", good[: int(share * len(good))]
    for place in (4, 8, -4, -8, -12, -40):
        raw = bytearray(good)
        raw[place] ^= 0xFF
        yield f"byte {place} turned", bytes(raw)
    yield "footer of four gigabytes", good[:-8] + struct.pack("<I", 0xFFFFFFF0) + b"PAR1"
    yield "head and tail alone", b"PAR1PAR1"
    yield "no rows", packed(plain.head(0))
    yield "one row", packed(plain.head(1))
    yield "one column", packed(plain.select("PV"))
    yield "no column", packed(pl.DataFrame())
    yield "lists", packed(plain.with_columns(PV=pl.concat_list("PV", "OP")))
    yield "structures", packed(plain.with_columns(PV=pl.struct("PV", "OP")))
    yield "bytes", packed(plain.with_columns(PV=pl.lit(b"\0\1")))
    yield "nothing but nulls", packed(plain.with_columns(PV=pl.lit(None), OP=pl.lit(None)))
    yield "true and false", packed(plain.with_columns(PV=pl.col("PV") > 4, OP=pl.col("OP") > 50))
    yield "nan and infinite", packed(plain.with_columns(PV=pl.lit(float("nan")), OP=pl.lit(float("inf"))))
    yield "times without an order", packed(plain.sample(fraction=1.0, shuffle=True, seed=1))
    yield "time in nulls", packed(plain.with_columns(time=pl.lit(None)))
    yield "days far away", packed(plain.with_columns(time=pl.lit(2**62).cast(pl.Datetime("us"))))
    yield "whole numbers beyond 64 bits", packed(plain.with_columns(PV=pl.lit(2**63, dtype=pl.UInt64)))
    yield "a thousand million rows in a few bytes", _row_bomb()
    yield "names that are patterns", packed(plain.rename({"PV": "^.*$", "OP": "*"}))


def _row_bomb() -> bytes:
    """A Parquet file of constants, 60 million rows that take a few kilobytes and its column 480 MB when read."""
    import polars as pl

    out = io.BytesIO()
    rows = 60_000_000
    frame = pl.select(pl.repeat(1, rows, dtype=pl.Int8).alias("time"))
    frame.with_columns(PV=pl.col("time"), OP=pl.col("time")).write_parquet(out, row_group_size=rows)
    return out.getvalue()


def encodings() -> Iterator[tuple[str, bytes]]:
    """Text in encodings of all kinds: what, content."""
    text = table(("time", "Durchfluß [m³/h].PV", "Öffnung.OP"))
    plain = table()
    for name in (
        "utf-8-sig",
        "utf-16",
        "utf-16-le",
        "utf-16-be",
        "utf-32",
        "utf-7",
        "cp1252",
        "cp437",
        "cp850",
        "cp500",
    ):
        yield name, text.replace("³", "2").encode(name, "replace")
    for name in ("shift_jis", "gb18030", "big5", "koi8-r", "euc_kr"):
        yield name, table(("time", "流量.PV", "弁.OP")).encode(name, "replace")
    yield "UTF-16 that breaks off in a sign", plain.encode("utf-16")[:-1]
    yield "mark of UTF-16 before UTF-8", b"\xff\xfe" + plain.encode()
    yield "mark of UTF-8 alone", b"\xef\xbb\xbf"
    yield "two marks", b"\xef\xbb\xbf\xef\xbb\xbf" + plain.encode()
    yield "mixed UTF-8 and Windows", text.encode() + b"40,4\xb0,50\n"
    yield "overlong UTF-8", plain.encode() + b"40,\xc0\xb4,50\n"
    yield "a lone surrogate", plain.encode() + b"40,\xed\xa0\x80,50\n"
    yield "beyond Unicode", plain.encode() + b"40,\xf8\x88\x80\x80\x80,50\n"
    yield "right to left", table(("time", "\u202eVP.PV", "\u2067OP.OP"))
    yield "nothing to see", table(("time", "PV\u200b", "OP\ufeff"))
    yield "Arabic figures", plain.replace("4.1", "٤٫١").encode()
    yield "wide figures", plain.replace("50", "50").encode()
    yield "true minus", plain.replace("4.1", "−4.1").encode()
    yield "hard spaces", plain.replace("4.1", "4\u00a0100,1").encode()
    yield "line separators", plain.replace("\n", "\u2028").encode()
    yield "NUL in a cell", plain.replace("4.1", "4\0.1").encode()
    yield "NUL at the end", plain.encode() + bytes(5000)
    yield "escape signs", plain.replace("4.1", "\x1b[31m4.1\x1b[0m").encode()
    yield "bells", plain.replace("4.1", "4.1\a").encode()
    yield "end of file in the middle", plain.replace("4.1", "4.1\x1a", 1).encode()
