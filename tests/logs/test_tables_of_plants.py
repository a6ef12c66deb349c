"""Late rows, marks between thousands, repeated columns, headers of two rows, and tables with blanks."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from stickslip.logs import ReadError, read_log, read_loop, read_loops

N = 60
CLOCK = [datetime(2024, 5, 6, 7) + timedelta(seconds=10 * i) for i in range(N)]
PV = [1240.0 + 0.5 * (i % 7) for i in range(N)]
OP = [40.0 + 0.25 * (i % 5) for i in range(N)]


def saved(folder, header: str, rows: list[str]):
    file = folder / "trend.csv"
    file.write_text(header + "\n" + "\n".join(rows) + "\n")
    return file


def test_one_late_row_is_put_in_its_place(tmp_path) -> None:
    rows = [f"{t},{pv},{op}" for t, pv, op in zip(CLOCK, PV, OP, strict=True)]
    rows.insert(45, rows.pop(30))
    loop = read_loop(saved(tmp_path, "time,PV,OP", rows))
    assert loop.pv.tolist() == PV and loop.op.tolist() == OP
    assert "1 row comes late and is put in place." in loop.notes


def test_a_late_row_of_a_long_table(tmp_path) -> None:
    rows = [f"{t},FIC1.PV,{pv}\n{t},FIC1.OP,{op}" for t, pv, op in zip(CLOCK, PV, OP, strict=True)]
    rows.insert(45, rows.pop(30))
    assert read_loop(saved(tmp_path, "time,tag,value", rows)).pv.tolist() == PV


def test_many_late_rows_are_refused(tmp_path) -> None:
    rows = [f"{t},{pv},{op}" for t, pv, op in zip(CLOCK, PV, OP, strict=True)]
    with pytest.raises(ReadError, match="earlier than the line before it"):
        read_loop(saved(tmp_path, "time,PV,OP", rows[30:] + rows[:30]))


@pytest.mark.parametrize(
    ("style", "decimal"),
    [("1,240.5", "."), ("1.240,5", ","), ("1 240.5", "."), ("1\u00a0240,5", ","), ("1'240.5", ".")],
)
def test_marks_between_the_thousands(tmp_path, style, decimal) -> None:
    mark = style[1]
    rows = []
    for t, pv, op in zip(CLOCK, PV, OP, strict=True):
        whole, fraction = f"{pv:.1f}".split(".")
        rows.append(f"{t};{whole[:-3]}{mark}{whole[-3:]}{decimal}{fraction};{str(op).replace('.', decimal)}")
    loop = read_loop(saved(tmp_path, "time;PV;OP", rows))
    assert loop.pv.tolist() == PV and loop.op.tolist() == OP
    assert any("between the thousands" in note for note in loop.notes)


def test_a_point_that_stands_elsewhere_is_no_mark_between_thousands(tmp_path) -> None:
    rows = [f"{t};12.345;50,5" for t in CLOCK[:20]] + [f"{t};12.34;50,5" for t in CLOCK[20:]]
    log = read_log(saved(tmp_path, "time;PV;OP", rows), decimal=",")
    assert log["PV"][0] == 12.345 and log["OP"][0] == 50.5


def test_identical_columns_of_one_name(tmp_path) -> None:
    rows = [f"{t},{pv},{op},{pv}" for t, pv, op in zip(CLOCK, PV, OP, strict=True)]
    loop = read_loop(saved(tmp_path, "time,FIC1.PV [m3/h],FIC1.OP,FIC1.PV [m3/h]", rows))
    assert loop.pv.tolist() == PV
    assert "A second column 'FIC1.PV [m3/h]' holds the same values and is passed over." in loop.notes


HEADERS = [
    "time,FIC1,FIC1,LIC2,LIC2\n,PV,OP,PV,OP",
    "Time,FIC1,,LIC2,\n,PV,OP,PV,OP",
    ",FIC1,FIC1,LIC2,LIC2\ntime,PV,OP,PV,OP",
]


@pytest.mark.parametrize("header", HEADERS)
def test_two_header_rows(tmp_path, header) -> None:
    rows = [f"{t},{pv},{op},{op},{pv / 20}" for t, pv, op in zip(CLOCK, PV, OP, strict=True)]
    first, second = read_loops(saved(tmp_path, header, rows))
    assert (first.name, second.name) == ("FIC1", "LIC2")
    assert first.pv.tolist() == PV and second.pv.tolist() == OP


def test_blanks_of_a_wide_table_are_held_as_in_a_long_one(tmp_path) -> None:
    wide, long = [], []
    for i, (t, pv, op) in enumerate(zip(CLOCK, PV, OP, strict=True)):
        row = {
            "FIC1.PV": pv if i % 2 == 0 else "",
            "FIC1.OP": op if i % 3 == 0 else "",
            "FIC1.SP": 1241 if i == 0 else "",
        }
        row["FIC1.x"] = i
        wide.append(",".join([str(t), *map(str, row.values())]))
        long += [f"{t},{tag},{value}" for tag, value in row.items() if value != ""]
    columns = {"PV": "FIC1.PV", "OP": "FIC1.OP", "SP": "FIC1.SP", "x": "FIC1.x"}
    (tmp_path / "long.csv").write_text("time,tag,value\n" + "\n".join(long) + "\n")
    of_wide = read_log(saved(tmp_path, "time,FIC1.PV,FIC1.OP,FIC1.SP,FIC1.x", wide), columns=columns)
    of_long = read_log(tmp_path / "long.csv", columns=columns)
    for name in columns:
        assert np.array_equal(of_wide[name], of_long[name], equal_nan=True)
    assert "FIC1.OP: reported in 20 of 60 rows, held from the report before in the others." in of_wide.notes
    assert of_wide["OP"][:5].tolist() == [OP[0], OP[0], OP[0], OP[3], OP[3]]


def test_a_stretch_without_data_stays_missing(tmp_path) -> None:
    rows = [f"{t},{'' if 20 <= i < 40 else pv},{op}" for i, (t, pv, op) in enumerate(zip(CLOCK, PV, OP, strict=True))]
    log = read_log(saved(tmp_path, "time,PV,OP", rows))
    assert np.isnan(log["PV"][20:40]).all()
