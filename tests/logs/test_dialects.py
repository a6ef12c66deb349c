"""The same small loop written in the dialects of historians and spreadsheets reads to the same numbers."""

from datetime import UTC, datetime

import numpy as np
import pytest
from stickslip.logs import read_log, read_loop

PV = [4.5, 4.25, 4.0]
OP = [50.0, 50.5, 51.25]

DIALECTS = {
    "plain": "time,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n",
    "semicolon and decimal comma": "time;PV;OP\n0;4,5;50\n10;4,25;50,5\n20;4,0;51,25\n",
    "tab": "time\tPV\tOP\n0\t4.5\t50\n10\t4.25\t50.5\n20\t4.0\t51.25\n",
    "tab and decimal comma": "time\tPV\tOP\n0\t4,5\t50\n10\t4,25\t50,5\n20\t4,0\t51,25\n",
    "spaces": "time  PV   OP\n0   4.5  50\n10  4.25 50.5\n20  4.0  51.25\n",
    "bar": "time|PV|OP\n0|4.5|50\n10|4.25|50.5\n20|4.0|51.25\n",
    "bare carriage returns": "time,PV,OP\r0,4.5,50\r10,4.25,50.5\r20,4.0,51.25\r",
    "Windows line ends": "time,PV,OP\r\n0,4.5,50\r\n10,4.25,50.5\r\n20,4.0,51.25\r\n",
    "no last line end": "time,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25",
    "UTF-8 with mark": "\ufefftime,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n",
    "UTF-16": "time,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n".encode("utf-16"),
    "Windows-1252": "time,PV [°C],OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n".encode("cp1252"),
    "all quoted": '"time","PV","OP"\n"0","4.5","50"\n"10","4.25","50.5"\n"20","4.0","51.25"\n',
    "quoted decimal commas": 'time,PV,OP\n0,"4,5",50\n10,"4,25","50,5"\n20,"4,0","51,25"\n',
    "comments and blank lines": "# plant 3\n\ntime,PV,OP\n# start\n0,4.5,50\n10,4.25,50.5\n\n20,4.0,51.25\n\n",
    "title lines": "Trend export\nPlant 3\ntime,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n",
    "separator hint": "sep=;\ntime;PV;OP\n0;4,5;50\n10;4,25;50,5\n20;4,0;51,25\n",
    "separator at the end": "time;PV;OP;\n0;4.5;50;\n10;4.25;50.5;\n20;4.0;51.25;\n",
    "separator at the end of rows only": "time,PV,OP\n0,4.5,50,\n10,4.25,50.5,\n20,4.0,51.25,\n",
    "spaces around": "time , PV , OP\n0 , 4.5 , 50\n10 , 4.25 , 50.5\n20 , 4.0 , 51.25\n",
    "row of units": "time;PV;OP\ns;m3/h;%\n0;4,5;50\n10;4,25;50,5\n20;4,0;51,25\n",
    "exponents": "time,PV,OP\n0,4.5E0,5e1\n1.0e1,42.5e-1,505E-1\n20,+4.0,51.25\n",
    "index column without a name": ",PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n",
    "time not named": "x,PV,OP\n0,4.5,50\n10,4.25,50.5\n20,4.0,51.25\n",
    "milliseconds": "time [ms],PV,OP\n0,4.5,50\n10000,4.25,50.5\n20000,4.0,51.25\n",
    "minutes": "Time (min),PV,OP\n0,4.5,50\n0.166666666666666667,4.25,50.5\n0.33333333333333333,4.0,51.25\n",
    "ISO": "timestamp,PV,OP\n2024-06-13 21:55:00,4.5,50\n2024-06-13 21:55:10,4.25,50.5\n"
    "2024-06-13 21:55:20,4.0,51.25\n",
    "ISO with T and Z": "timestamp,PV,OP\n2024-06-13T21:55:00Z,4.5,50\n2024-06-13T21:55:10Z,4.25,50.5\n"
    "2024-06-13T21:55:20Z,4.0,51.25\n",
    "ISO with offset and fractions": "timestamp,PV,OP\n2024-06-13T23:55:00.000+02:00,4.5,50\n"
    "2024-06-13T23:55:10.000+02:00,4.25,50.5\n2024-06-13T23:55:20.000+02:00,4.0,51.25\n",
    "PI": "Time,PV,OP\n13-Jun-24 21:55:00,4.5,50\n13-Jun-24 21:55:10,4.25,50.5\n13-Jun-24 21:55:20,4.0,51.25\n",
    "PI with fractions": "Time,PV,OP\n13-Jun-2024 21:55:00.000,4.5,50\n13-Jun-2024 21:55:10.0,4.25,50.5\n"
    "13-Jun-2024 21:55:20,4.0,51.25\n",
    "dotted": "Time;PV;OP\n13.06.2024 21:55:00;4,5;50\n13.06.2024 21:55:10;4,25;50,5\n13.06.2024 21:55:20;4,0;51,25\n",
    "US": "Time,PV,OP\n6/13/2024 9:55:00 PM,4.5,50\n6/13/2024 9:55:10 PM,4.25,50.5\n6/13/2024 9:55:20 PM,4.0,51.25\n",
    "British": "Time,PV,OP\n13/06/2024 21:55:00,4.5,50\n13/06/2024 21:55:10,4.25,50.5\n13/06/2024 21:55:20,4.0,51.25\n",
    "compact": "Time,PV,OP\n20240613 215500,4.5,50\n20240613T215510,4.25,50.5\n20240613 21:55:20,4.0,51.25\n",
    "date and time apart": "Date,Time,PV,OP\n13-Jun-24,21:55:00,4.5,50\n13-Jun-24,21:55:10,4.25,50.5\n"
    "13-Jun-24,21:55:20,4.0,51.25\n",
    "seconds since 1970": "time,PV,OP\n1718315700,4.5,50\n1718315710,4.25,50.5\n1718315720,4.0,51.25\n",
    "milliseconds since 1970": "time,PV,OP\n1718315700000,4.5,50\n1718315710000,4.25,50.5\n1718315720000,4.0,51.25\n",
    "spreadsheet days": "time,PV,OP\n45456.913194444445,4.5,50\n45456.91331018518,4.25,50.5\n"
    "45456.913425925926,4.0,51.25\n",
    "time of day": "time,PV,OP\n23:59:50,4.5,50\n00:00:00,4.25,50.5\n00:00:10,4.0,51.25\n",
    "long": "tag,time,value\nPV,0,4.5\nOP,0,50\nPV,10,4.25\nOP,10,50.5\nPV,20,4.0\nOP,20,51.25\n",
    "long with quality, tag by tag": "TagName;TimeStamp;Value;Quality\n"
    "FIC1.PV;13-Jun-24 21:55:00;4,5;Good\nFIC1.PV;13-Jun-24 21:55:10;4,25;Good\n"
    "FIC1.PV;13-Jun-24 21:55:20;4,0;Good\nFIC1.OP;13-Jun-24 21:55:00;50;Good\n"
    "FIC1.OP;13-Jun-24 21:55:10;50,5;Good\nFIC1.OP;13-Jun-24 21:55:20;51,25;Good\n",
}


@pytest.mark.parametrize("text", DIALECTS.values(), ids=DIALECTS)
def test_one_loop_in_many_dialects(write, text):
    loop = read_loop(write(text))
    assert loop.pv.tolist() == PV  # exact: the texts are the shortest forms of these doubles
    assert loop.op.tolist() == OP
    assert np.allclose(loop.t - loop.t[0], [0, 10, 20], rtol=0, atol=1e-9)
    assert loop.good.all()
    assert loop.sp is None


@pytest.mark.parametrize(
    "name",
    ["ISO", "PI", "PI with fractions", "dotted", "US", "British", "compact", "date and time apart"],
)
def test_local_stamps_tell_the_start(write, name):
    assert read_log(write(DIALECTS[name])).start == datetime(2024, 6, 13, 21, 55)


@pytest.mark.parametrize(
    "name",
    ["ISO with T and Z", "ISO with offset and fractions", "seconds since 1970", "milliseconds since 1970"],
)
def test_absolute_stamps_tell_the_start_in_utc(write, name):
    assert read_log(write(DIALECTS[name])).start == datetime(2024, 6, 13, 21, 55, tzinfo=UTC)


def test_spreadsheet_days_tell_the_start(write):
    start = read_log(write(DIALECTS["spreadsheet days"])).start
    assert abs((start - datetime(2024, 6, 13, 21, 55)).total_seconds()) < 0.01


@pytest.mark.parametrize(("name", "unit"), [("row of units", "m3/h"), ("Windows-1252", "°C")], ids=["row", "header"])
def test_units_are_kept(write, name, unit):
    assert read_loop(write(DIALECTS[name])).log.units["PV"] == unit


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("semicolon and decimal comma", "decimal commas"),
        ("title lines", "2 lines above the header"),
        ("time not named", "'x', is taken as the time"),
        ("minutes", "read in min"),
        ("seconds since 1970", "seconds since 1970"),
        ("spreadsheet days", "day serials"),
        ("time of day", "Midnight is passed 1 time."),
    ],
)
def test_assumptions_are_noted(write, name, words):
    assert any(words in note for note in read_loop(write(DIALECTS[name])).notes)


def test_plain_file_needs_few_notes(write):
    notes = read_loop(write("time,SP,PV,OP\n0,5,4.5,50\n10,5,4.25,50.5\n20,5,4,51\n", "FIC7.csv")).notes
    assert notes == (
        "Time has no unit: it is read as seconds, 10 s apart.",
        "OP is taken as % of its span (values 50 to 51).",
        "The process is taken as self-regulating: FIC7 is a flow loop.",
    )


def test_time_format_is_obeyed(write):
    path = write("time,PV,OP\n01/02/24,4,50\n02/02/24,4,51\n")
    assert read_log(path, time_format="%d/%m/%y").start == datetime(2024, 2, 1)
    assert read_log(path, time_format="%m/%d/%y").start == datetime(2024, 1, 2)


def test_day_and_month_order_that_runs_shorter_is_taken(write):
    # 1, 2, 3 February in British order; 2 January, 2 February, 2 March in American order.
    log = read_log(write("time,PV\n01/02/2024 00:00,1\n02/02/2024 00:00,2\n03/02/2024 00:00,3\n"))
    assert log.start == datetime(2024, 2, 1)
    assert log.t.tolist() == [0.0, 86400.0, 172800.0]
    assert any("day/month/year" in note for note in log.notes)


def test_two_digit_years_and_noon(write):
    log = read_log(write("time,PV\n12/31/99 12:00:00 AM,1\n12/31/99 12:00:00 PM,2\n1/1/00 1:00:00 AM,3\n"))
    assert log.start == datetime(1999, 12, 31)
    assert log.t.tolist() == [0.0, 43200.0, 90000.0]


def test_interval_stands_in_for_a_useless_time(write):
    # Stamps of minute resolution over samples of 20 s.
    text = "time,PV,OP\n" + "".join(f"2024-01-01 00:0{i // 3}:00,{i},50\n" for i in range(9))
    loop = read_loop(write(text), interval=20.0)
    assert loop.t.tolist() == [20.0 * i for i in range(9)]
    assert any("20 s apart, as stated" in note for note in loop.notes)


def clock_rows(*stamps: str) -> str:
    return "time,PV,OP\n" + "".join(f"{stamp},{i},50\n" for i, stamp in enumerate(stamps))


def test_end_of_summer_time_is_undone(write):
    path = write(clock_rows("2024-10-27 02:59:40", "2024-10-27 02:59:50", "2024-10-27 02:00:00", "2024-10-27 02:00:10"))
    loop = read_loop(path)
    assert loop.t.tolist() == [0, 10, 20, 30]
    assert any("back one hour" in note for note in loop.notes)


def test_a_number_that_steps_back_an_hour_is_no_clock_change(write):
    from stickslip.logs import ReadError

    with pytest.raises(ReadError, match="earlier"):
        read_loop(write("time,PV,OP\n0,1,50\n10,2,50\n20,3,50\n-3570,4,50\n-3560,5,50\n"))


def test_repeated_rows_are_dropped_and_counted(write):
    loop = read_loop(write("time,PV,OP\n0,1,50\n1,2,51\n1,2,51\n1,2,51\n2,,52\n2,,52\n"))
    assert loop.t.tolist() == [0, 1, 2]
    assert "3 repeated rows dropped." in loop.notes


def test_gaps_and_uneven_sampling_are_noted(write):
    text = "time,PV,OP\n0,1,50\n1,1,50\n2,1,50\n3,1,50\n4.8,1,50\n60,1,50\n61,1,50\n"
    notes = read_loop(write(text)).notes
    assert "1 gap in time, the longest 55.2 s." in notes
    assert any(note.startswith("Sampling is uneven: 1 to 1.8 s apart") for note in notes)


def test_text_columns_are_left_out_of_a_log(write):
    log = read_log(write("time,PV,remark\n0,1,start\n1,2,\n2,3,end\n"))
    assert log.names == ("PV",)
    assert any("'remark' holds no number" in note for note in log.notes)


def test_text_in_other_columns_does_not_stop_a_loop(write):
    assert len(read_loop(write("time,PV,OP,lab\n0,1,50,7.1\n1,2,51,see book\n"))) == 2


def test_columns_are_picked_and_renamed(write):
    log = read_log(write("time,a,b,c\n0,1,2,x\n1,3,4,y\n"), columns={"PV": "b", "OP": "a"})
    assert log.names == ("PV", "OP")
    assert log["PV"].tolist() == [2, 4]
