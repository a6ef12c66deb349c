"""Broken and hostile files, made by rule: the same list every time, and as many more as are asked for by a seed.

``files()`` lists them by kind; ``mutated`` breaks a good file at random places.  Nothing here is data of a plant.
"""

# ruff: noqa: E501  one hostile file a line

import gzip
import io
import random
import struct
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta

__all__ = ["INJECTIONS", "Hostile", "files", "good_rows", "mutated"]

ROWS = 40  # of a file that is good but for one thing: enough to be read, too few to be judged


@dataclass(frozen=True)
class Hostile:
    """One hostile file: what is wrong with it, its name, its bytes."""

    what: str
    name: str
    content: bytes


def good_rows(count: int = ROWS) -> list[tuple[str, str, str]]:
    """Time [s], PV and OP of a plain record as text."""
    return [(str(i), f"{4 + 0.1 * (i % 7):.1f}", str(50 + i % 5)) for i in range(count)]


def table(
    header: tuple[str, ...] = ("time", "PV", "OP"), rows: list[tuple[str, str, str]] | None = None, cut: str = ",",
    end: str = "\n",
) -> str:  # fmt: skip
    """A table of text."""
    lines = [cut.join(header), *(cut.join(row) for row in (good_rows() if rows is None else rows))]
    return end.join(lines) + end


def files() -> Iterator[Hostile]:
    """Every hostile file, one kind after the other; the names are unique."""
    for number, (kind, what, content, ending) in enumerate(_all()):
        data = content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content
        yield Hostile(f"{kind}: {what}", f"h{number:03d}.{ending}", data)


def mutated(content: bytes, seed: int) -> bytes:
    """The bytes with one to eight random changes: flipped, cut out, doubled, or replaced by what breaks parsers."""
    draw = random.Random(seed)
    raw = bytearray(content)
    for _ in range(draw.randint(1, 8)):
        place = draw.randrange(len(raw) + 1)
        width = min(draw.choice((1, 1, 2, 8, 64)), len(raw) - place)
        change = draw.randrange(4)
        if change == 0 and place < len(raw):
            raw[place] ^= 1 << draw.randrange(8)
        elif change == 1:
            del raw[place : place + width]
        elif change == 2:
            raw[place:place] = raw[place : place + width] * draw.choice((1, 3))
        else:
            raw[place : place + width] = draw.choice(_SPLINTERS)
        if not raw:
            return bytes(draw.choice(_SPLINTERS))
    return bytes(raw)


_SPLINTERS = (
    b"", b"\0", b"\xff\xfe", b'"', b'""', b"\n", b"\r", b",", b";", b"\t", b"nan", b"inf", b"-1", b"1e999", b"\xc3", b"=",
    b"<b>", b"9" * 400, b"0001-01-01", b"2024-02-30 25:61", b"\xe2\x80\xa8", b"#", b"PAR1", b"\x1f\x8b", b"PK\x03\x04",
)  # fmt: skip

Made = Iterator[tuple[str, str, str | bytes, str]]


def _all() -> Made:
    yield from (("container", what, raw, ending) for what, raw, ending in _containers())
    yield from (("workbook", what, raw, "xlsx") for what, raw in _workbooks())
    yield from (("parquet", what, raw, "parquet") for what, raw in _parquets())
    yield from (("encoding", what, raw, "csv") for what, raw in _encodings())
    yield from (("shape", what, text, "csv") for what, text in _shapes())
    yield from (("value", what, text, "csv") for what, text in _values())
    yield from (("time", what, text, "csv") for what, text in _times())
    yield from (("name", what, text, "csv") for what, text in _names())


def _zipped(*members: tuple[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members:
            archive.writestr(name, content)
    return buffer.getvalue()


def _patched(raw: bytes, old: bytes, new: bytes) -> bytes:
    assert old in raw and len(old) == len(new)
    return raw.replace(old, new)


def _containers() -> Iterator[tuple[str, bytes, str]]:
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


def _workbooks() -> Iterator[tuple[str, bytes]]:
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


def _parquets() -> Iterator[tuple[str, bytes]]:
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


def _encodings() -> Iterator[tuple[str, bytes]]:
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


def _shapes() -> Iterator[tuple[str, str]]:
    good = table()
    body = "".join(",".join(row) + "\n" for row in good_rows())
    yield "header alone", "time,PV,OP\n"
    yield "header and units alone", "time,PV,OP\ns,m3/h,%\n"
    yield "header without a line end", "time,PV,OP"
    yield "one row", "time,PV,OP\n0,4,50\n"
    yield "two rows", "time,PV,OP\n0,4,50\n1,5,51\n"
    yield "one column", "PV\n" + "4\n" * 40
    yield "two columns", "time,PV\n" + "".join(f"{i},4\n" for i in range(40))
    yield "no header", body
    yield "header twice", "time,PV,OP\n" + good
    yield "header at the end", body + "time,PV,OP\n"
    yield "header again and again", "".join("time,PV,OP\n" + line + "\n" for line in body.split("\n")[:-1])
    yield "blank lines alone", "\n" * 5000
    yield "separators alone", ",,,,\n" * 500
    yield "quotation marks alone", '"' * 5001
    yield "comments alone", "# nothing\n" * 5000
    yield "a short row", good.replace("\n7,4.0,52", "\n7,4.0")
    yield "a long row", good.replace("\n7,4.0,52", "\n7,4.0,52,1,2,3")
    yield "a last row that breaks off", good[:-4]
    yield "every row of another width", "time,PV,OP\n" + "".join("1," * (i % 9) + "1\n" for i in range(200))
    yield "an open quotation mark", good.replace("4.1", '"4.1', 1)
    yield "a quotation mark inside", good.replace("4.1", '4"1', 1)
    yield "a quoted separator", good.replace("4.1", '"4,1"', 1)
    yield "a quoted line end", good.replace("4.1", '"4\n1"', 1)
    yield (
        "quotation marks everywhere",
        "\n".join(",".join(f'"{c}"' for c in line.split(",")) for line in good.split("\n")),
    )
    yield (
        "other separators in other rows",
        "".join(line.replace(",", ";,\t|"[i % 4]) + "\n" for i, line in enumerate(good.split("\n"))),
    )
    yield "all line ends", good.replace("\n", "\r", 10).replace("\n", "\r\n", 10)
    yield "carriage returns alone", good.replace("\n", "\r")
    yield "a line of 20 million signs", good + "9" * 20_000_000 + "\n"
    yield "a header of 5 million signs", "time," + "P" * 5_000_000 + ",OP\n" + body
    yield "a million columns", ",".join(f"c{i}" for i in range(1_000_000)) + "\n" + "0," * 999_999 + "0\n"
    yield "a million columns, one row too long", "time" + ",PV" * 1_000_000 + "\n"
    yield (
        "three thousand columns",
        "time," + ",".join(f"F{i}.PV" for i in range(3000)) + "\n" + ("0" + ",1" * 3000 + "\n") * 5,
    )
    yield (
        "fifty loops of three rows",
        "time"
        + "".join(f",F{i}.PV,F{i}.OP" for i in range(50))
        + "\n"
        + "".join(f"{r}" + ",1,2" * 50 + "\n" for r in range(3)),
    )
    yield "thirty thousand rows of one value", "time,PV,OP\n" + "".join(f"{i},1,2\n" for i in range(30_000))
    yield "columns without names", ",,\n" + body
    yield "the same name twice", good.replace("PV,OP", "PV,PV")
    yield "the same name after trimming", good.replace("PV,OP", "OP, OP ")
    yield "the same name in other letters", good.replace("PV,OP", "pv,PV")
    yield "the same letters composed otherwise", good.replace("PV,OP", "\u00e9.PV,e\u0301.PV")
    yield "three times the time", good.replace("PV,OP", "time,time")
    yield "PV alone", good.replace("PV,OP", "PV,PV2")
    yield "signals of two loops", good.replace("PV,OP", "F1.PV,F2.OP")
    yield "JSON", '{"time": [0, 1], "PV": [1, 2]}'
    yield "JSON lines", '{"time": 0, "PV": 1}\n' * 40
    yield "YAML", "time:\n  - 0\nPV:\n  - 1\n" * 20
    yield "a web page", "<!DOCTYPE html><script>alert(1)</script>"
    yield "XML with entities", '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><x>&a;</x>'
    yield "a program", "import os\nos.system('touch /tmp/stickslip-escaped.csv')\n" * 10
    yield "SQL", "INSERT INTO trend VALUES (0, 1, 2); DROP TABLE loops;\n" * 40
    yield "prose", "Dear all, here is the trend, as agreed.\nRegards,\nN. N.\n" * 10
    yield "a heading of ours without rows", '# stickslip log 1\n# signal: {"name": "PV"}\n'
    yield "a heading of ours that is damaged", "# stickslip log 1\n# start: {\n# loop: [[[[\n" + good
    yield "a heading of ours of deep brackets", "# stickslip log 1\n# note: " + "[" * 100_000 + "\n" + good
    yield "a long table of one tag", "tag,time,value\n" + "".join(f"FIC1.PV,{i},4\n" for i in range(40))
    yield (
        "a long table without times in common",
        "tag,time,value\n" + "".join(f"FIC1.{'PV' if i < 20 else 'OP'},{i * 1000},4\n" for i in range(40)),
    )
    yield "a long table of a thousand tags", "tag,time,value\n" + "".join(f"T{i}.PV,{i},4\n" for i in range(1000))


_WORDS = (
    "nan", "NaN", "inf", "-inf", "Infinity", "1e308", "-1e308", "1e400", "-1e400", "1e-320", "0x1F", "1_000", "1 000",
    "1,000.5", "1.000,5", "1,23,4", "50 %", "true", "#N/A", "#DIV/0!", "=1+1", "'5", "+5", "--5", "5-", "(5)", "5e", "1d3",
    "NULL", "None", "\\N", "?", "-", "9" * 400, "0." + "0" * 400 + "1", "Bad", "\u221e", "½", "1/2", "4..1", "4,1,", "4;1",
)  # fmt: skip


def _values() -> Iterator[tuple[str, str]]:
    for word in _WORDS:
        cell = f'"{word}"' if "," in word else word
        yield (
            f"{word[:12]!r} once",
            table(rows=[(t, cell if i == 7 else pv, op) for i, (t, pv, op) in enumerate(good_rows())]),
        )
    for word in ("nan", "inf", "1e308", "-1e308", "1e-320", "", "Bad", "0", "1e15"):
        yield f"{word!r} everywhere", table(rows=[(t, word, op) for t, _, op in good_rows()])
    swing = [(t, f"{(-1) ** i}e308", f"{(-1) ** i}e307") for i, (t, _, _) in enumerate(good_rows(200))]
    yield "from -1e308 to 1e308", table(rows=swing)
    yield (
        "steps of 1e-300",
        table(rows=[(t, f"{i % 7}e-300", f"{i % 5}e-300") for i, (t, _, _) in enumerate(good_rows(200))]),
    )
    yield (
        "a large number that hardly changes",
        table(rows=[(t, f"{10**15 + i % 3}", f"{10**15 + i % 2}") for i, (t, _, _) in enumerate(good_rows(200))]),
    )
    yield (
        "decimal marks mixed",
        table(cut=";", rows=[(t, pv.replace(".", ",.;"[i % 2]), op) for i, (t, pv, op) in enumerate(good_rows())]),
    )
    yield "decimal mark of the separator", table(rows=[(t, pv.replace(".", ","), op) for t, pv, op in good_rows()])


def _stamped(stamps: list[str], cut: str = ",") -> str:
    return table(
        rows=[(stamp, pv, op) for stamp, (_, pv, op) in zip(stamps, good_rows(len(stamps)), strict=True)], cut=cut
    )


def _clock(start: datetime, step: float, count: int = ROWS) -> list[datetime]:
    return [start + timedelta(seconds=step * i) for i in range(count)]


def _times() -> Iterator[tuple[str, str]]:
    number = [float(i) for i in range(ROWS)]
    usual = [stamp.isoformat(sep=" ") for stamp in _clock(datetime(2024, 10, 27), 300.0)]
    for what, numbers in (
        ("falling", number[::-1]), ("shuffled", random.Random(1).sample(number, ROWS)), ("all alike", [5.0] * ROWS),
        ("all zero", [0.0] * ROWS), ("negative", [t - 1e6 for t in number]), ("two alike", [0.0, 0.0, *number[2:]]),
        ("back once", [*number[:20], 3.0, *number[21:]]), ("a gap of a hundred years", [*number[:20], *(t + 3e9 for t in number[20:])]),
        ("a gap of 1e300", [*number[:39], 1e300]), ("steps of 1e-12", [1e-12 * t for t in number]), ("beyond exactness", [1e17 + t for t in number]),
        ("seconds since 1970", [1.7e9 + t for t in number]), ("milliseconds since 1970", [1.7e12 + 1e3 * t for t in number]),
        ("nanoseconds since 1970", [1.7e18 + 1e9 * t for t in number]), ("seconds before 1970", [-1.7e9 + t for t in number]),
        ("days of a spreadsheet", [45_000 + t / 86_400 for t in number]), ("FILETIME", [1.336e17 + 1e7 * t for t in number]),
        ("1e308", [1e308] * ROWS), ("growing tenfold", [10.0**i for i in range(ROWS)]),
    ):  # fmt: skip
        yield what, _stamped([repr(t) for t in numbers])
    for word in (
        "",
        "nan",
        "inf",
        "-inf",
        "now",
        "=NOW()",
        "0000-00-00 00:00:00",
        "2024-02-30 00:00:00",
        "24:00:00",
        "?",
    ):
        yield f"{word!r} once", _stamped([*usual[:7], word, *usual[8:]])
        yield f"{word!r} everywhere", _stamped([word] * ROWS)
    for what, start in (("1600", datetime(1600, 1, 1)), ("1899", datetime(1899, 12, 30)), ("1969", datetime(1969, 12, 31, 23, 59)),
                        ("year 1", datetime(1, 1, 1)), ("9999", datetime(9999, 12, 31)), ("2038", datetime(2038, 1, 19, 3, 14))):  # fmt: skip
        yield f"stamps of {what}", _stamped([stamp.isoformat(sep=" ") for stamp in _clock(start, 1.0)])
    yield "year 10000", _stamped([f"10000-01-01 00:00:{i:02d}" for i in range(ROWS)])
    yield (
        "year of two figures",
        _stamped([stamp.strftime("%d-%m-%y %H:%M:%S") for stamp in _clock(datetime(1999, 12, 31, 23, 59), 10.0)]),
    )
    yield "day or month", _stamped([stamp.strftime("%d/%m/%Y") for stamp in _clock(datetime(2024, 1, 1), 86_400.0, 12)])
    yield "a leap second", _stamped([*usual[:7], "2024-10-27 00:34:60", *usual[8:]])
    yield (
        "a repeated hour",
        _stamped([(datetime(2024, 10, 27, 2) + timedelta(minutes=5 * (i % 12))).isoformat() for i in range(24)]),
    )
    yield (
        "an hour repeated three times",
        _stamped([(datetime(2024, 10, 27, 2) + timedelta(minutes=5 * (i % 12))).isoformat() for i in range(36)]),
    )
    yield (
        "a missing hour",
        _stamped([stamp.isoformat(sep=" ") for stamp in _clock(datetime(2024, 3, 31, 1), 300.0) if stamp.hour != 2]),
    )
    yield "zones mixed", _stamped([stamp + ("Z", "+02:00", "-05:30", " CET")[i % 4] for i, stamp in enumerate(usual)])
    yield "zones in half of the rows", _stamped([stamp + ("Z" if i % 2 else "") for i, stamp in enumerate(usual)])
    yield "a zone that there is not", _stamped([f"{stamp} Europe/Atlantis" for stamp in usual])
    yield "a zone of 99 hours", _stamped([f"{stamp}+99:99" for stamp in usual])
    yield (
        "formats mixed",
        _stamped(
            [
                (s.isoformat(), s.strftime("%d.%m.%Y %H:%M"), s.strftime("%m/%d/%y %I:%M %p"))[i % 3]
                for i, s in enumerate(_clock(datetime(2024, 10, 27), 300.0))
            ]
        ),
    )
    yield "numbers and stamps mixed", _stamped([stamp if i % 2 else str(i) for i, stamp in enumerate(usual)])
    yield (
        "clock without a day, past midnight",
        _stamped([s.strftime("%H:%M:%S") for s in _clock(datetime(2024, 1, 1, 23, 50), 60.0)]),
    )
    yield "days alone, all one", _stamped(["2024-10-27"] * ROWS)
    yield "months that nobody knows", _stamped([f"{1 + i % 28:02d}-Foo-24 00:00:00" for i in range(ROWS)])
    yield "stamps of a thousand signs", _stamped([stamp + "0" * 1000 for stamp in usual])


INJECTIONS = (
    "<script>alert(1)</script>", "<img src=x onerror=alert(1)>", "\"><svg onload=alert(1)>", "</style><script>alert(1)</script>",
    "</title><script>alert(1)</script>", "javascript:alert(1)", "<a href='http://127.0.0.1:9/'>x</a>", "&lt;script&gt;", "<!--",
    "]]><script>alert(1)</script>", "{{7*7}}", "${7*7}", "=HYPERLINK(A1)", "=cmd|' /C calc'!A0", "+1+1", "-1+1", "@SUM(A1)",
    "\t=1+1", "\uff1d1+1", "%0A=1+1", "../../../../etc/passwd", "/etc/passwd", "..\\..\\x", "C:\\x", "CON", "\x1b]0;owned\x07", "\x1b[2J",
    "[red]x[/red]", "$\\frac{1}{", "$x_{", "\\begin{x}", "%s%n{0}", "^.*$", "*", "a\u0000b", "\u202egpj", "x" * 10_000, "'", "''", "`",
    "; DROP TABLE loops", "__class__", "time", "null", "-rf", "~", "\N{GRINNING FACE}", "\r\r", "a/b", "https://127.0.0.1:9/x.js",
)  # fmt: skip


def _names() -> Iterator[tuple[str, str]]:
    for text in INJECTIONS:
        cell = text.replace('"', '""')
        yield f"tag {text[:24]!r}", table(("time", f'"{cell}.PV"', f'"{cell}.OP"'))
    for text in ("<script>alert(1)</script>", "=1+1", "$\\frac{"):
        yield f"unit {text[:24]!r}", table(("time", f'"PV [{text[:18]}]"', f'"OP [{text[:18]}]"'))
        yield f"comment {text[:24]!r}", f"# {text}\n" + table()
        yield f"other column {text[:24]!r}", _beside(text)
        yield f"mode {text[:24]!r}", _moded(text)


def _beside(name: str) -> str:
    lines = [f'time,PV,OP,"{name}"', *(",".join((*row, "1")) for row in good_rows())]
    return "\n".join(lines) + "\n"


def _moded(word: str) -> str:
    lines = ["time,PV,OP,MODE", *(",".join((*row, word if i % 2 else "AUTO")) for i, row in enumerate(good_rows()))]
    return "\n".join(lines) + "\n"
