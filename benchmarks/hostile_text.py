"""Hostile files of plain text: odd shapes, values, times and names."""

# ruff: noqa: E501  one hostile file a line

import random
from collections.abc import Iterator
from datetime import datetime, timedelta

from benchmarks.hostile_rows import ROWS, good_rows, table

__all__ = ["INJECTIONS", "names", "shapes", "times", "values"]


def shapes() -> Iterator[tuple[str, str]]:
    """Tables of odd shapes: what, text."""
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


def values() -> Iterator[tuple[str, str]]:
    """Cells that are hardly numbers: what, text."""
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


def times() -> Iterator[tuple[str, str]]:
    """Stamps of all kinds: what, text."""
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


def names() -> Iterator[tuple[str, str]]:
    """Tags, units, modes and comments that would run: what, text."""
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
