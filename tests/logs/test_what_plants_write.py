"""Every row of docs/reading.md: a small file of that kind, what is read of it, what is said, and how to insist."""

import gzip
import io
import zipfile
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from stickslip.logs import ReadError, read_loop, read_loops

N = 40
PV = [round(4.0 + 0.1 * (i % 7), 1) for i in range(N)]
OP = [50 + i % 5 for i in range(N)]
DAY = datetime(2024, 5, 6, 7)


def lines(stamps, cut=",", head="time,FIC101.PV,FIC101.OP", pv=PV, op=OP):
    rows = [cut.join(map(str, row)) for row in zip(stamps, pv, op, strict=True)]
    return "\n".join([head.replace(",", cut), *rows]) + "\n"


def clock(form="%Y-%m-%d %H:%M:%S", step=10, start=DAY):
    return [(start + timedelta(seconds=step * i)).strftime(form) for i in range(N)]


def zipped(content):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("FIC101.csv", content)
    return buffer.getvalue()


PLAIN = lines(clock())
BACKWARDS = "\n".join([PLAIN.split("\n")[0], *PLAIN.strip().split("\n")[:0:-1]]) + "\n"
LATE = PLAIN.strip().split("\n")
LATE.insert(30, LATE.pop(20))
PAIRS = "FIC101.PV,,FIC101.OP,\n" + "".join(
    f"{a},{pv},{b},{op}\n"
    for a, pv, b, op in zip(clock(), PV, clock(start=DAY + timedelta(seconds=3)), OP, strict=True)
)
LONG = "tag,time,value,quality\n" + "".join(
    f"FIC101.PV,{t},{pv},Good\nFIC101.OP,{t},{op},Good\n" for t, pv, op in zip(clock(), PV, OP, strict=True)
)
BLANKS = "time,FIC101.PV,FIC101.OP,FIC101.SP\n" + "".join(
    f"{t},{pv},{op},{5 if i % 8 == 0 else ''}\n" for i, (t, pv, op) in enumerate(zip(clock(), PV, OP, strict=True))
)
SEPTEMBER = [(datetime(2024, 10, 27, 0, 40, tzinfo=UTC) + timedelta(minutes=2 * i)) for i in range(N)]
SUMMER = [(t + timedelta(hours=2 if t.hour < 1 else 1)).strftime("%Y-%m-%d %H:%M:%S") for t in SEPTEMBER]

# row of the page -> content, interval [s], words that the notes hold
READ = {
    "comma": (PLAIN, 10.0, ()),
    "semicolon and decimal comma": (lines(clock(), ";", pv=[str(v).replace(".", ",") for v in PV]), 10.0, ()),
    "tab": (lines(clock(), "\t"), 10.0, ()),
    "UTF-16 with its mark": (PLAIN.encode("utf-16"), 10.0, ()),
    "Windows-1252": (lines(clock(), head="Zeit,FIC101.PV [m³/h],FIC101.OP").encode("cp1252"), 10.0, ()),
    "gzip": (gzip.compress(PLAIN.encode()), 10.0, ("gzip",)),
    "zip": (zipped(PLAIN), 10.0, ("zip",)),
    "newest row first": (BACKWARDS, 10.0, ("newest",)),
    "one late row": ("\n".join(LATE), 10.0, ("1 row comes late",)),
    "two header rows": (lines(clock(), head=",FIC101,\ntime,PV,OP"), 10.0, ("two rows",)),
    "units row": (lines(clock(), head="time,FIC101.PV,FIC101.OP\n,m3/h,%"), 10.0, ()),
    "titles above": ("Trend of unit 3\nmade on Monday\n" + PLAIN, 10.0, ("above the header",)),
    "footer": (PLAIN + "end of report\n", 10.0, ("passed over",)),
    "a column twice": (
        "\n".join(f"{line},{line.split(',')[1]}" for line in PLAIN.strip().split("\n")), 10.0, ("same values",),
    ),
    "PI DataLink": (PAIRS, None, ("time of its own",)),
    "long": (LONG, 10.0, ()),
    "blanks that hold": (BLANKS, 10.0, ("SP",)),
    "seconds since 1970": (lines([1_714_978_800 + 10 * i for i in range(N)]), 10.0, ("seconds since 1970",)),
    "milliseconds since 1970": (lines([1_714_978_800_000 + 10_000 * i for i in range(N)]), 10.0, ("milliseconds",)),
    "spreadsheet days": (lines([45_418.0 + i / 8640 for i in range(N)]), 10.0, ("spreadsheet day",)),
    "zone Z": (lines(clock("%Y-%m-%dT%H:%M:%SZ")), 10.0, ()),
    "zone +02:00": (lines(clock("%Y-%m-%dT%H:%M:%S+02:00")), 10.0, ()),
    "zone CEST": (lines(clock("%Y-%m-%d %H:%M:%S CEST")), 10.0, ()),
    "day first": (lines(clock("%d.%m.%Y %H:%M:%S")), 10.0, ()),
    "AM and PM": (lines(clock("%m/%d/%Y %I:%M:%S %p")), 10.0, ("read as",)),
    "month by name": (lines(clock("%d-%b-%y %H:%M:%S")), 10.0, ()),
    "the repeated hour": (lines(SUMMER), 120.0, ("steps back one hour",)),
    "stamps of minutes": (lines(clock("%Y-%m-%d %H:%M")), 10.0, ("rounded to 60 s",)),
    "thousands": (lines(clock(), ";", pv=[f"1.{100 + i:d},5" for i in range(N)]), 10.0, ("thousands",)),
    "digital states": (
        lines(clock(), pv=["Bad Input" if i == 9 else v for i, v in enumerate(PV)]), 10.0, ("Bad Input",),
    ),
    "quality column": (
        lines(clock(), head="time,FIC101.PV,FIC101.OP,FIC101.PV.quality", op=[f"{v},{'Bad' if i == 9 else 'Good'}"
              for i, v in enumerate(OP)]), 10.0, ("quality",),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", READ)
def test_it_is_read_and_what_was_assumed_is_said(read, name):
    content, interval, words = READ[name]
    record = read(content)
    assert record.name == "FIC101" and len(record) >= N - 1
    assert interval is None or record.dt == pytest.approx(interval, rel=1e-3)
    notes = " ".join(record.notes)
    for word in words:
        assert word in notes, notes
    if name == "thousands":
        assert record.pv[:2].tolist() == [1100.5, 1101.5]
    elif name in ("digital states", "quality column"):
        bad = ~record.log.good(record.pv_name) if hasattr(record, "pv_name") else np.isnan(record.pv)
        assert bad.sum() == 1 and bad[9]
    elif name != "PI DataLink":
        assert record.pv.tolist() == PV and record.op.tolist() == OP
    if name == "blanks that hold":
        assert record.sp.tolist() == [5.0] * N
    if name.startswith("zone"):
        assert record.log.start is not None
    if name == "units row":
        assert record.log.units[record.pv_name] == "m3/h"


@pytest.mark.parametrize(
    ("content", "options", "piece"),
    [
        (lines(clock("%m/%d/%Y %H:%M:%S")), {"time_format": "%d/%m/%Y %H:%M:%S"}, "2024-06-05"),
        (lines([10_000 * i for i in range(N)]), {"time_unit": "ms"}, 10.0),
        (lines([10_000 * i for i in range(N)]), {"time_unit": "s"}, 10_000.0),
        ("FIC101.PV;FIC101.OP\n" + "".join(f"{a};{b}\n" for a, b in zip(PV, OP, strict=True)), {"interval": 2.0}, 2.0),
        (lines(clock(), ";", pv=[f"1.{100 + i}" for i in range(N)]), {"decimal": ","}, 1100.0),
        (lines(clock(), ";", pv=[f"1.{100 + i}" for i in range(N)]), {"decimal": "."}, 1.1),
        (PLAIN.replace(",", "|"), {"separator": "|"}, 10.0),
    ],
)
def test_it_can_be_overridden(read, content, options, piece):
    record = read(content, **options)
    if isinstance(piece, str):
        assert record.log.start.isoformat().startswith(piece)
    elif "decimal" in options:
        assert record.pv[0] == pytest.approx(piece)
    else:
        assert record.dt == pytest.approx(piece)


def test_an_hour_that_comes_three_times_is_refused_with_the_remedy(read):
    stamps = [(datetime(2024, 10, 27, 2) + timedelta(minutes=5 * (i % 12))).isoformat() for i in range(N)]
    with pytest.raises(ReadError, match="export in UTC if the clock was set back"):
        read(lines(stamps))


def test_several_loops_of_one_file(tmp_path):
    head = "time,FIC101.PV,FIC101.OP,LIC7.PV,LIC7.OP"
    path = tmp_path / "unit.csv"
    path.write_text(lines(clock(), head=head, op=[f"{v},{v / 2},{v / 4}" for v in OP]))
    assert [record.name for record in read_loops(path)] == ["FIC101", "LIC7"]
    with pytest.raises(ReadError, match="--loop"):
        read_loop(path)
    assert read_loop(path, loop="LIC7").process == "integrating"


def test_a_workbook(read):
    pytest.importorskip("python_calamine")
    from benchmarks.hostile_binary import sheet_rows, workbook

    days = [str(45_418.0 + i / 8640) for i in range(N)]
    cells = [("time", "FIC101.PV", "FIC101.OP"), *zip(days, map(str, PV), map(str, OP), strict=True)]
    record = read(workbook(sheet_rows(cells)))
    assert record.pv.tolist() == PV and record.dt == pytest.approx(10.0, rel=1e-3)
    assert "sheet 'Trend'" in " ".join(record.notes)
