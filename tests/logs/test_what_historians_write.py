"""Small files as historians write them, each of which was once read wrongly or refused."""

from datetime import datetime, timedelta

import numpy as np
import pytest

from logs import ReadError, read_loop

N = 40
DAY = datetime(2024, 5, 6, 7)


def table(stamps, pv=None, op=None, head="time,FIC101.PV,FIC101.OP"):
    rows = len(stamps)
    pv = [round(4.0 + 0.1 * (i % 7), 1) for i in range(rows)] if pv is None else pv
    op = [50 + i % 5 for i in range(rows)] if op is None else op
    return "\n".join([head, *(",".join(map(str, row)) for row in zip(stamps, pv, op, strict=True))]) + "\n"


def clock(form="%Y-%m-%d %H:%M:%S", step=10.0, start=DAY, rows=N):
    return [(start + timedelta(seconds=step * i)).strftime(form) for i in range(rows)]


@pytest.fixture
def read(tmp_path):
    def reading(content, **told):
        path = tmp_path / "export.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_loop(path, **told)

    return reading


def said(record, *words):
    return any(all(word in note for word in words) for note in record.notes)


@pytest.mark.parametrize(
    ("form", "step"), [("%Y%m%d%H%M%S", 10.0), ("%Y%m%d%H%M", 60.0), ("%Y%m%d%H%M", 3600.0), ("%Y%m%d", 86400.0)]
)
def test_calendar_times_without_marks_are_no_seconds(read, form, step):
    record = read(table(clock(form, step)))
    assert record.dt == pytest.approx(step)
    assert record.log.start == datetime.strptime(DAY.strftime(form), form)
    assert said(record, DAY.strftime(form), "2024-05-06")


def test_calendar_times_of_typed_columns():
    pl = pytest.importorskip("polars")
    for kind in (pl.Int64, pl.Float64):
        stamps = pl.Series([int(stamp) for stamp in clock("%Y%m%d%H%M%S")], dtype=kind)
        frame = pl.DataFrame({"time": stamps, "PV": np.sin(np.arange(N)), "OP": np.cos(np.arange(N))})
        assert read_loop(frame).log.start == DAY


@pytest.mark.parametrize(
    ("first", "step", "unit"),
    [
        (1_714_978_800, 10, "seconds since 1970"),
        (852_076_800_000, 10_000, "milliseconds since 1970"),  # 1997: twelve digits, as YYYYMMDDHHMM has
        (20_240_506, 10_000, "milliseconds"),  # eight digits of a counter
        (20_240_200, 1, "seconds"),  # a month's 30 February among the numbers
    ],
)
def test_counts_stay_counts(read, first, step, unit):
    assert said(read(table([first + step * i for i in range(N)])), unit)


def test_a_unit_said_goes_before_the_calendar(read):
    assert read(table(clock("%Y%m%d%H%M%S")), time_unit="s").log.start is None


def test_a_parquet_file_with_a_column_of_nulls_and_numbers_as_categories(tmp_path):
    pl = pytest.importorskip("polars")
    pv = [f"{4 + 0.1 * (i % 7):.1f}" for i in range(N)]
    frame = pl.DataFrame(
        {
            "time": [float(10 * i) for i in range(N)],
            "FIC101.PV": pl.Series(pv[:-1] + ["Bad Input"], dtype=pl.Categorical),
            "FIC101.OP": pl.Series([f" {50 + i % 5}".encode() for i in range(N)], dtype=pl.Binary),
            "FIC101.MV": pl.Series([None] * N, dtype=pl.Null),
        }
    )
    path = tmp_path / "trend.parquet"
    frame.write_parquet(path)
    record = read_loop(path)
    assert record.pv[:-1].tolist() == [float(cell) for cell in pv[:-1]] and np.isnan(record.pv[-1])
    assert record.op.tolist() == [50.0 + i % 5 for i in range(N)]
    assert said(record, "FIC101.MV", "40 cells are blank") and said(record, "Bad Input")


def test_few_repeated_stamps_with_other_values_keep_the_later_row(read):
    rows = table(clock(rows=750)).strip().split("\n")
    last = rows[-1].split(",")
    record = read("\n".join([*rows, f"{last[0]},9.5,{last[2]}"]))
    assert len(record) == 750 and record.pv[-1] == 9.5
    assert said(record, "line 752", "the later is kept")
    many = [line for row in rows[1:] for line in (row, row.replace(",4", ",9"))]
    with pytest.raises(ReadError, match="have the same time"):
        read("\n".join([rows[0], *many[:60]]))
