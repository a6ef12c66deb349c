"""Digital states, blanks, quality columns and modes."""

import numpy as np
import pytest
from stickslip.logs import read_log, read_loop

STATES = [
    "Bad Input",
    "I/O Timeout",
    "No Data",
    "Shutdown",
    "Scan Off",
    "Configure",
    "Pt Created",
    "[-11059] No Good Data For Calculation",
    "#N/A",
    "#VALUE!",
    "BAD",
    "1.#QNAN",
]


@pytest.mark.parametrize("state", STATES)
def test_states_are_missing(write, state):
    log = read_log(write(f"time,PV\n0,1.5\n1,{state}\n2,2.5\n"))
    assert np.isnan(log["PV"][1])
    assert log.good("PV").tolist() == [True, False, True]
    assert any(note.startswith("PV: 1 cell") for note in log.notes)


def test_states_are_counted_by_kind(write):
    log = read_log(write("time,PV\n0,1\n1,Bad Input\n2,Bad Input\n3,No Data\n4,\n"))
    assert log.notes == (
        "Time has no unit: it is read as seconds, 1 s apart.",
        "PV: 2 cells say 'Bad Input': missing, of bad quality.",
        "PV: 1 cell says 'No Data': missing, of bad quality.",
        "PV: 1 cell is blank: missing.",
    )
    # A state says that the value is bad; a blank only that there is none.
    assert log.quality["PV"].tolist() == [True, False, False, False, True]


@pytest.mark.parametrize(
    ("marks", "good"),
    [
        (("Good", "Bad", "Uncertain"), (True, False, False)),
        (("192", "0", "64"), (True, False, False)),
        (("216", "192", "24"), (True, True, False)),
        (("0", "2147483648", "1073741824"), (True, False, False)),
        (("1", "0", "1"), (True, False, True)),
        (("True", "False", "True"), (True, False, True)),
    ],
    ids=["words", "OPC DA", "OPC DA, local override", "OPC UA", "flag", "boolean"],
)
def test_quality_columns(write, marks, good):
    rows = "".join(f"{i},{i}.5,{mark}\n" for i, mark in enumerate(marks))
    log = read_log(write(f"time,FIC1.PV,FIC1.PV.Quality\n{rows}"))
    assert log.names == ("FIC1.PV",)
    assert log.good("FIC1.PV").tolist() == list(good)
    assert np.isfinite(log["FIC1.PV"]).all(), "the value itself is kept"


def test_quality_that_cannot_be_told_is_not_used(write):
    log = read_log(write("time,PV,PV_status\n0,1,0\n1,2,0\n"))
    assert log.good("PV").all()
    assert any("'PV_status' cannot be recognised" in note for note in log.notes)


def test_modes_are_numbers_and_held(write):
    text = "time,PV,OP,MODE\n0,1,50,MAN\n1,1,50,\n2,1,50,AUTO\n3,1,50,CAS\n4,1,50,Bad Input\n5,1,50,\n6,1,50,LO\n"
    loop = read_loop(write(text))
    assert np.array_equal(loop.mode, [0, 0, 1, 2, np.nan, np.nan, 0], equal_nan=True)
    assert loop.good.tolist() == [False, False, True, True, False, False, False]
    assert any("'LO' counted as manual" in note for note in loop.notes)


def test_numbers_as_modes(write):
    loop = read_loop(write("time,PV,OP,MODE\n0,1,50,1\n1,1,50,0\n2,1,50,2\n"))
    assert loop.mode.tolist() == [1, 0, 2]
    assert any("0 manual, 1 automatic, 2 cascade" in note for note in loop.notes)


def test_unknown_mode_numbers_leave_the_mode_out(write):
    loop = read_loop(write("time,PV,OP,MODE\n0,1,50,16\n1,1,50,8\n"))
    assert loop.mode is None
    assert loop.good.all()
    assert any("16, 8 are not known as modes" in note for note in loop.notes)


WORDS = {
    1.0: "AUTO Aut automatic Automatik AUTOMATISCH Automatique Automático automatico Automatisk Automaatti 自动 Авто",
    2.0: "CAS RCAS Cascade Kaskade KASK Cascada Cascata Kaskad Каскад",
    0.0: "MAN Manual Hand Handbetrieb Manuell Manuel Manuale Ручной 手动",
}


@pytest.mark.parametrize(("number", "word"), [(number, w) for number, words in WORDS.items() for w in words.split()])
def test_modes_in_the_words_of_other_languages(write, number, word):
    loop = read_loop(write(f"time,PV,OP,MODE\n0,1,50,{word}\n1,1,50,{word}\n"))
    assert loop.mode.tolist() == [number, number]
    assert not any("counted as manual" in note for note in loop.notes)


@pytest.mark.parametrize(
    ("text", "number"), [("16 AUTO", 1), ("AUTO (2)", 1), ("P-AUTO", 1), ("AUT IMAN", 0), ("Auto tune", 0), ("LO", 0)]
)
def test_modes_with_something_beside_them(write, text, number):
    assert read_loop(write(f"time,PV,OP,MODE\n0,1,50,{text}\n1,1,50,{text}\n")).mode[0] == number
