"""Exports as plants make them: each holds the same loop, and reads to the same numbers."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from stickslip.logs import Log, ReadError, read_log, read_loop

N = 12
START = datetime(2024, 10, 13, 21, 55)
CLOCK = [START + timedelta(seconds=10 * i) for i in range(N)]
PV = [4.0 + 0.25 * (i % 5) for i in range(N)]
OP = [50.0 + 0.5 * (i % 3) for i in range(N)]


def lines(head: str, row: str, stamp: str = "%Y-%m-%d %H:%M:%S") -> str:
    """A header and one line a row; the template knows {t}, {i}, {pv}, {op}, {pvc} and {opc} with decimal commas."""
    return head + "".join(
        row.format(
            t=f"{moment:{stamp}}", i=i, pv=pv, op=op, pvc=str(pv).replace(".", ","), opc=str(op).replace(".", ",")
        )
        for i, (moment, pv, op) in enumerate(zip(CLOCK, PV, OP, strict=True))
    )


PLAIN = "Time,FIC1.PV,FIC1.OP\n", "{t},{pv},{op}\n"
EXPORTS = {  # name -> (text, words that a note must hold)
    "rows of blank cells below": (lines(*PLAIN) + ",,\n,,\n", "2 rows of blank cells"),
    "end of a report": (lines(*PLAIN) + "\nEnd of report\n", "'End of report'"),
    "last row breaks off": (lines(*PLAIN) + "2024-10-13 21:57:00,4.", "'2024-10-13 21:57:00,4.'"),
    "two-line footer": (lines(*PLAIN) + "Rows: 12\nUser: abc\n", "The last 2 lines"),
    "descriptions and units": (
        lines("Time,FIC1.PV,FIC1.OP\n,Feed flow to the reactor,Feed valve demand signal\n,m3/h,%\n", PLAIN[1]),
        "Line 2 holds words",
    ),
    "units below the name in a cell": (lines('Time,"FIC1.PV\nm3/h","FIC1.OP\n%"\n', PLAIN[1]), ""),
    "inch mark in a title": (lines('Trend of the 5" valve\n' + PLAIN[0], PLAIN[1]), "1 line above"),
    "titles filled up by a spreadsheet": (
        lines("Trend;;\nFrom;13.10.2024;\nTime;FIC1.PV;FIC1.OP\n", "{t};{pvc};{opc}\n", "%d.%m.%Y %H:%M:%S"),
        "2 lines above",
    ),
    "row numbers without a name": (lines(",Time,FIC1.PV,FIC1.OP\n", "{i},{t},{pv},{op}\n"), "'row'"),
    "a time for every signal": (lines("Time,FIC1.PV,Time,FIC1.OP\n", "{t},{pv},{t},{op}\n"), "a time of its own"),
    "a time for every signal, one shorter": (
        lines("Time,FIC1.PV,Time,FIC1.OP\n", "{t},{pv},{t},{op}\n") + ",,2024-10-13 21:57:00,50\n",
        "a time of its own",
    ),
    "zone names": (lines(PLAIN[0], "{t} CEST,{pv},{op}\n"), ""),
    "German month": (lines(PLAIN[0], PLAIN[1], "%d-Okt-24 %H:%M:%S"), ""),
    "Spanish month": (lines(PLAIN[0], PLAIN[1], "%d oct. 2024 %H:%M:%S"), ""),
    "narrow space before PM": (lines(PLAIN[0], PLAIN[1], "%m/%d/%Y %I:%M:%S\u202fPM"), ""),
    "Spanish p. m.": (lines(PLAIN[0], PLAIN[1], "%d/%m/%Y %I:%M:%S p. m."), ""),
    "German date and clock": (
        lines("Datum;Uhrzeit;FIC1.Istwert;FIC1.Stellwert\n", "{t};{pvc};{opc}\n", "%d.%m.%Y;%H:%M:%S"),
        "'FIC1.Istwert' is read as PV.",
    ),
    "midnight behind the date": (lines("Date,Time,FIC1.PV,FIC1.OP\n", PLAIN[1], "%Y-%m-%d 00:00:00,%H:%M:%S"), ""),
    "WinCC": (
        lines(
            '"VarName";"TimeString";"VarValue";"Validity";"Time_ms"\n',
            '"FIC1_PV";"{t}";{pvc};1;45456913194,4\n"FIC1_OP";"{t}";{opc};1;45456913194,4\n',
            "%d.%m.%Y %H:%M:%S",
        ),
        "'Time_ms' (no part of a long table)",
    ),
    "InfluxDB": (
        lines(
            "#group,false,false\n,result,table,_time,_value,_field\n",
            ",,0,{t},{pv},FIC1.PV\n,,0,{t},{op},FIC1.OP\n",
            "%Y-%m-%dT%H:%M:%S",
        ),
        "not used",
    ),
    "month name first": (lines("Time;FIC1.PV;FIC1.OP\n", "{t};{pv};{op}\n", "%b %d, %Y %I:%M:%S %p"), ""),
    "units without brackets": (lines("Time,FIC1.PV m3/h,FIC1.OP %\n", PLAIN[1]), ""),
    "descriptions in the names": (lines("Time,FIC1.PV - Feed flow,FIC1.OP - Feed valve\n", PLAIN[1]), ""),
    "PI Vision": (
        lines('"Data Source","Time","Value","Units"\n', '"FIC1.PV",{t},{pv},"m3/h"\n"FIC1.OP",{t},{op},"%"\n'),
        "'Units' (no part of a long table)",
    ),
    "Yokogawa": (
        lines("Date,Time,FIC1.PV,FIC1.MV,FIC1.MODE\n", "{t},{pv},{op},AUT\n", "%Y/%m/%d,%H:%M:%S"),
        "'FIC1.MV' is taken as OP",
    ),
    "source and server time": (
        lines("ServerTimestamp,SourceTimestamp,FIC1.PV,FIC1.OP\n", "2024-10-13 23:00:00,{t},{pv},{op}\n"),
        "'ServerTimestamp' (the time is 'SourceTimestamp')",
    ),
    "newest first": (
        PLAIN[0] + "".join(line + "\n" for line in reversed(lines("", PLAIN[1]).splitlines())),
        "other way round",
    ),
}


@pytest.mark.parametrize("name", EXPORTS)
def test_exports_read_to_the_same_loop(write, name):
    text, words = EXPORTS[name]
    loop = read_loop(write(text))
    assert loop.log.start == START
    assert loop.t[:N].tolist() == [10.0 * i for i in range(N)]
    assert loop.pv[:N].tolist() == PV and loop.op[:N].tolist() == OP
    assert loop.good[:N].all()
    assert any(words in note for note in loop.notes) or not words, loop.notes


def test_offsets_without_minutes(write):
    loop = read_loop(write(lines(PLAIN[0], "{t}+02,{pv},{op}\n")))  # as PostgreSQL writes them
    assert loop.log.start.isoformat() == "2024-10-13T19:55:00+00:00"


def test_units_of_descriptions_and_cells_are_kept(write):
    for name in ("descriptions and units", "units below the name in a cell"):
        assert read_loop(write(EXPORTS[name][0])).log.units == {"PV": "m3/h", "OP": "%"}


def test_signals_with_times_of_their_own_meet_on_one_axis(write):
    text = "Time,FIC1.PV,Time,FIC1.OP\n0,1,0,50\n2,3,1,60\n4,5,4,70\n"
    loop = read_loop(write(text))
    assert loop.t.tolist() == [0, 1, 2, 4]
    assert loop.pv.tolist() == [1, 2, 3, 5]  # analytic: on the line between reports
    assert loop.op.tolist() == [50, 60, 60, 70]  # analytic: held


def test_a_broken_row_among_others_is_still_refused(write):
    broken = lines(*PLAIN).splitlines()
    broken[5] = broken[5].rsplit(",", 1)[0]
    with pytest.raises(ReadError, match="line 6 has 2 cells"):
        read_loop(write("\n".join(broken) + "\n"))


@pytest.mark.parametrize("name", ["*", "^a.*$", ".*"])
@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_names_that_look_like_patterns_are_names(tmp_path, name, ending):
    log = Log(t=[0, 1], signals={name: [0.0, np.nan], "abc": [1.0, 2.0]})
    getattr(log, f"to_{ending}")(tmp_path / "log")
    again = read_log(tmp_path / "log")
    assert again.names == (name, "abc")
    assert np.array_equal(again[name], [0.0, np.nan], equal_nan=True) and again["abc"].tolist() == [1, 2]


def test_a_clock_of_two_figures_says_how_it_is_read(write):
    loop = read_loop(write("time,PV,OP\n00:00,1,50\n00:01,2,51\n00:02,1,50\n"))
    assert loop.dt == 60.0
    assert "Time is a time of day without a date, read as hours:minutes." in loop.notes
