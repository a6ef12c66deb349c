"""Small files as historians write them, each of which was once read wrongly or refused."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from stickslip.logs import ReadError, read_loop

N = 40
DAY = datetime(2024, 5, 6, 7)


def table(stamps, pv=None, op=None, head="time,FIC101.PV,FIC101.OP"):
    rows = len(stamps)
    pv = [round(4.0 + 0.1 * (i % 7), 1) for i in range(rows)] if pv is None else pv
    op = [50 + i % 5 for i in range(rows)] if op is None else op
    return "\n".join([head, *(",".join(map(str, row)) for row in zip(stamps, pv, op, strict=True))]) + "\n"


def clock(form="%Y-%m-%d %H:%M:%S", step=10.0, start=DAY, rows=N):
    return [(start + timedelta(seconds=step * i)).strftime(form) for i in range(rows)]


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


@pytest.mark.parametrize("clock_form", ["%H%M%S", "%H%M"])
def test_date_and_time_in_two_columns_of_figures(read, clock_form):
    step = 10.0 if clock_form == "%H%M%S" else 60.0
    stamps = [f"{day},{at}" for day, at in zip(clock("%Y%m%d", step), clock(clock_form, step), strict=True)]
    record = read(table(stamps, head="date,time,FIC101.PV,FIC101.OP"))
    assert record.dt == step and record.log.start == DAY and not said(record, "not used")


def test_a_program_dropped_the_zeros_in_front_of_the_time(tmp_path):
    pl = pytest.importorskip("polars")
    day = DAY.replace(hour=9, minute=58)
    columns = {form: [int(stamp) for stamp in clock(form, start=day)] for form in ("%Y%m%d", "%H%M%S")}
    frame = pl.DataFrame(columns | {"PV": np.sin(np.arange(N)), "OP": np.cos(np.arange(N))})
    frame = frame.rename({"%Y%m%d": "Date", "%H%M%S": "Time"})
    record = read_loop(frame)
    assert record.dt == 10.0 and record.log.start == day


def test_a_count_beside_dates_of_figures_stays_the_time(read):
    stamps = [f"20240506,{10 * i}" for i in range(N)]
    assert read(table(stamps, head="date,time,FIC101.PV,FIC101.OP")).log.start is None


@pytest.mark.parametrize("head", ["时间", "time"])
@pytest.mark.parametrize(
    "form",
    [
        "2024年5月6日 %H:%M:%S",
        "2024年05月06日%H时%M分%S秒",
        "2024年5月6日 上午7：%M：%S",
        "2024년 5월 6일 오전 7:%M:%S",
    ],
)
def test_stamps_of_east_asia(read, head, form):
    record = read(table(clock(form), head=f"{head},FIC101.PV,FIC101.OP"))
    assert record.dt == 10.0 and record.log.start == DAY


def test_the_afternoon_in_chinese(read):
    assert read(table(clock("2024年5月6日 下午1:%M:%S"))).log.start == DAY.replace(hour=13)


def test_a_unit_said_goes_before_the_calendar(read):
    assert read(table(clock("%Y%m%d%H%M%S")), time_unit="s").log.start is None


def test_a_parquet_file_with_a_column_of_nulls_and_numbers_as_categories(tmp_path):
    pl = pytest.importorskip("polars")
    pv = [f"{4 + 0.1 * (i % 7):.1f}" for i in range(N)]
    frame = pl.DataFrame(
        {
            "time": [float(10 * i) for i in range(N)],
            "FIC101.PV": pl.Series([*pv[:-1], "Bad Input"], dtype=pl.Categorical),
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
    few = rows[:100]
    for i in (70, 50, 30):
        few.insert(i, few[i].replace(",4", ",9"))
    with pytest.raises(ReadError, match="lines 31 and 32 have the same time"):
        read("\n".join(few))


def spring(form="%Y-%m-%d %H:%M:%S", step=120, at=datetime(2024, 3, 31, 2), rows=80):
    """Clock times of central Europe: at two o'clock of 31 March the clock shows three."""
    moments = [at + timedelta(seconds=step * (i - 40)) for i in range(rows)]
    return [(m + timedelta(hours=m >= at)).strftime(form) for m in moments]


def autumn(step=120, start=datetime(2024, 10, 27, 2, 20), rows=80):
    """Clock times of central Europe: at three o'clock of 27 October the clock shows two again."""
    moments = [start + timedelta(seconds=step * i) for i in range(rows)]
    return [(m - timedelta(hours=m.hour >= 3)).strftime("%Y-%m-%d %H:%M:%S") for m in moments]


@pytest.mark.parametrize("step", [10, 120, 3600])
def test_the_hour_that_spring_leaves_out_is_no_gap(read, step):
    record = read(table(spring(step=step)))
    assert np.ptp(np.diff(record.t)) == 0.0
    assert said(record, "start of summer time") and not said(record, "gap")


@pytest.mark.parametrize(
    "stamps",
    [
        spring(at=datetime(2024, 3, 30, 2)),  # a Saturday
        spring(at=datetime(2024, 6, 30, 2)),  # a Sunday in June
        spring("%Y-%m-%dT%H:%M:%SZ"),  # UTC knows no summer time
        spring(at=datetime(2024, 3, 31, 12)),  # nobody sets clocks at noon
        [s for s in clock(step=120, start=datetime(2024, 3, 31, 1, 30), rows=80) if not "02:10" < s[11:16] <= "03:10"],
    ],
)
def test_an_hour_without_rows_stays_a_gap_elsewhere(read, stamps):
    record = read(table(stamps))
    assert not said(record, "summer time") and said(record, "1 gap")


def test_newest_first_across_the_hour_that_comes_twice(read):
    head, *rows = table(autumn()).strip().split("\n")
    forward, backward = read("\n".join([head, *rows])), read("\n".join([head, *rows[::-1]]))
    assert np.array_equal(backward.t, 120.0 * np.arange(80)) and np.array_equal(forward.t, backward.t)
    assert np.array_equal(forward.pv, backward.pv) and forward.log.start == backward.log.start
    assert said(backward, "newest") and said(backward, "end of summer time")


@pytest.mark.parametrize("stamps", [autumn(), spring()])
@pytest.mark.parametrize("order", ["by time", "by tag", "newest first"])
def test_the_change_of_the_clock_in_a_long_table(read, stamps, order):
    pv = [(i, f"FIC101.PV,{stamp},{4 + i % 7}") for i, stamp in enumerate(stamps)]
    op = [(i, f"FIC101.OP,{stamp},{50 + i % 5}") for i, stamp in enumerate(stamps)]
    sp = [(i, f"FIC101.SP,{stamps[i]},{i}") for i in (0, 78)]  # reported before and after the change only
    rows = [*pv, *op, *sp] if order == "by tag" else sorted([*pv, *op, *sp], reverse=order == "newest first")
    record = read("\n".join(["tag,time,value", *(row for _, row in rows)]))
    assert np.array_equal(record.t, 120.0 * np.arange(80))
    assert record.pv.tolist() == [4 + i % 7 for i in range(80)]
    assert record.sp.tolist() == [0.0] * 78 + [78.0] * 2


@pytest.mark.parametrize("cell", ["-999", "-9999", "-999.25", "9999999", "1e31", "-32768", "3.402823466e38"])
def test_numbers_that_stand_for_no_number_are_missing(read, cell):
    pv = [cell if i in (9, 10, 25) else 4 + 0.1 * (i % 7) for i in range(N)]
    record = read(table(clock(), pv))
    assert np.flatnonzero(np.isnan(record.pv)).tolist() == [9, 10, 25]
    assert np.flatnonzero(~record.log.good("PV")).tolist() == [9, 10, 25]
    assert said(record, "FIC101.PV: 3 values are", "missing, of bad quality")


@pytest.mark.parametrize("cell", ["-9999", "9999999", "1e31"])
def test_one_such_number_is_enough_where_no_measurement_is_as_far(read, cell):
    # before: one -9999 in 2,700 rows of a sticky loop took the probability of stiction from 98 to 9 %, without a note
    record = read(table(clock(), [cell if i == 9 else 40 + 0.1 * (i % 7) for i in range(N)]))
    assert np.flatnonzero(np.isnan(record.pv)).tolist() == [9]
    assert said(record, "FIC101.PV: 1 value is", "missing, of bad quality")


@pytest.mark.parametrize("cell", ["-999", "-999.25", "9999"])
def test_one_such_number_that_is_nearer_is_kept_and_told(read, cell):
    # before: one -999 in 1,764 rows took the probability of stiction from 94 to 33 %, without a note
    pv = [cell if i == 9 else 700 + i % 7 if cell == "9999" else 100 + i % 7 for i in range(N)]
    record = read(table(clock(), pv))
    assert record.pv[9] == float(cell) and said(record, f"1 value is {cell}, far outside the others", "kept", "blank")


def test_two_such_numbers_in_one_typed_column():
    pl = pytest.importorskip("polars")
    pv = [{9: -9999.0, 10: -9999.0, 20: 1e31, 21: 1e31}.get(i, 4 + 0.1 * (i % 7)) for i in range(N)]
    frame = pl.DataFrame({"time": [10.0 * i for i in range(N)], "PV": pv, "OP": [50.0 + i % 5 for i in range(N)]})
    assert np.flatnonzero(np.isnan(read_loop(frame).pv)).tolist() == [9, 10, 20, 21]


@pytest.mark.parametrize(
    "pv",
    [
        [999 if i % 9 == 0 else 990 + i % 7 for i in range(N)],  # among the others
        [999 if i % 9 == 0 else 100 + i % 7 for i in range(N)],  # a gauge at its end
        [65535 if i % 9 == 0 else 60000 + i % 7 for i in range(N)],  # a converter at its end
        [-999 if i % 9 == 0 else -900 - i % 7 for i in range(N)],
        [-9999 if i == 9 else 900 + i % 7 for i in range(N)],  # once, and not 20 times as large as the others
        [-9999] * N,  # there is nothing beside it
        [123456 if i % 9 == 0 else 4 + i % 7 for i in range(N)],  # far, of no such form
        [0 if i < 20 else 9999 for i in range(N)],  # off, then at a value
    ],
)
def test_what_may_be_measured_is_kept(read, pv):
    record = read(table(clock(), pv))
    assert record.pv.tolist() == pv and not said(record, "no number")
    assert said(record, "may be measured") == (pv.count(-9999) == 1)


def test_a_mark_that_may_stand_between_thousands_is_said(read):
    whole = [f"{1 + i % 3}.{100 * (i % 7):03d}" if i % 2 else str(900 + i) for i in range(N)]
    record = read(table(clock(), whole))
    assert record.pv[1] == 2.1 and said(record, "'2.100' beside whole numbers is read as 2.1", "--decimal")
    decimal_comma = read(table(clock(), whole).replace(",", ";"), decimal=",")
    assert decimal_comma.pv[1] == 2100 and not said(decimal_comma, "beside whole numbers")


@pytest.mark.parametrize(
    "pv",
    [
        [f"{1 + 0.001 * i:.3f}" for i in range(N)],  # three decimals throughout
        [f"{1 + 0.05 * i:g}" for i in range(N)],  # 1, 1.05, 1.1
        [f"{i / 1000:.3f}" if i else "0" for i in range(N)],  # 0, 0.001
    ],
)
def test_plain_decimals_are_not_doubted(read, pv):
    assert not said(read(table(clock(), pv)), "beside whole numbers")


@pytest.mark.parametrize(
    ("words", "code"),
    [
        ("时间,流量 [吨/时],阀门开度", "gbk"),
        ("時刻,流量,バルブ開度", "cp932"),
        ("Zeit,Größe [m³/h],Öffnung", "cp1252"),
        ("Zeit,Temperatur [°C],Öffnung", "cp1252"),
        ("heure,débit,régulé à 5 µm", "cp1252"),
        ("hora,presión,posición ±1", "cp1252"),
        ("tid,flöde,läge ÅÄÖ", "cp1252"),
        ("Zeit,Größe,Stellung", "cp1252"),
    ],
)
def test_text_is_read_in_its_own_encoding(read, words, code):
    time, pv, op = words.split(",")
    content = table(clock(), head=words).encode(code)
    record = read(content, time=time, pv=pv.partition(" [")[0], op=op)
    assert record.log.units.get("PV", "") == (pv.partition("[")[2].strip("]"))


def test_numbers_that_carry_their_unit(read):
    pv = [f"{40 + i % 7}.0 bar" if i != 9 else "Bad Input" for i in range(N)]
    record = read(table(clock(), pv, [f"{45 + i % 5}.5%" for i in range(N)]))
    assert record.pv[:3].tolist() == [40.0, 41.0, 42.0] and record.op[:2].tolist() == [45.5, 46.5]
    assert (record.log.units["PV"], record.log.units["OP"]) == ("bar", "%") and np.isnan(record.pv[9])
    assert said(record, "FIC101.PV", "'bar'")


def test_a_decimal_comma_before_a_unit(read):
    rows = [f"{stamp};{4 + i % 7},250 bar;{45 + i % 5},5 %" for i, stamp in enumerate(clock())]
    record = read("\n".join(["time;FIC101.PV;FIC101.OP", *rows]))
    assert record.pv[:2].tolist() == [4.25, 5.25] and record.op[0] == 45.5


def test_units_of_the_tags_of_a_long_table(read):
    rows = [
        f"{tag},{stamp},{value}"
        for i, stamp in enumerate(clock())
        for tag, value in (("FIC101.PV", f"{4 + i % 7} m3/h"), ("FIC101.OP", f"{50 + i % 5} %"))
    ]
    record = read("\n".join(["tag,time,value", *rows]))
    assert record.pv[:2].tolist() == [4.0, 5.0] and record.log.units["OP"] == "%"


@pytest.mark.parametrize("minus", ["\u2212", "\u2013", "\uff0d"])
def test_a_minus_of_print(read, minus):
    pv = [f"{minus}{1 + i % 7}.5" for i in range(N)]
    pv[3] = f"{minus}1.5e{minus}1"
    record = read(table(clock(), pv))
    assert record.pv[:4].tolist() == [-1.5, -2.5, -3.5, -0.15]


@pytest.mark.parametrize(
    ("pv", "head"),
    [
        ([f"{4 + i % 7} {'bar' if i < 20 else 'kPa'}" for i in range(N)], "time,FIC101.PV,FIC101.OP"),  # two units
        ([f"{4 + i % 7} kPa" for i in range(N)], "time,FIC101.PV [bar],FIC101.OP"),  # not that of the header
        ([f"{4 + i % 7} apples" for i in range(N)], "time,FIC101.PV,FIC101.OP"),
    ],
)
def test_units_that_cannot_be_told_are_refused(read, pv, head):
    with pytest.raises(ReadError, match="is not a number"):
        read(table(clock(), pv, head=head))
