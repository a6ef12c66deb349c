"""Long tables: one row a value."""

import numpy as np
from stickslip.logs import read_log, read_loop


def test_tags_reported_at_their_own_times(write):
    text = "tag,time,value\nFIC1.PV,0,1.0\nFIC1.PV,4,5.0\nFIC1.PV,8,5.0\nFIC1.OP,0,50\nFIC1.OP,2,60\nFIC1.OP,8,70\n"
    loop = read_loop(write(text))
    # The output holds, the measurement runs along straight lines (analytic).
    assert loop.t.tolist() == [0, 2, 4, 8]
    assert loop.op.tolist() == [50, 60, 60, 70]
    assert loop.pv.tolist() == [1, 3, 5, 5]
    assert "FIC1.OP: reported at 3 of 4 times, held from the report before at the others." in loop.notes
    assert "FIC1.PV: reported at 3 of 4 times, on the line between reports at the others." in loop.notes


def test_nothing_is_made_up_outside_the_reports(write):
    text = "tag,time,value\nFIC1.PV,2,1\nFIC1.PV,4,3\nFIC1.OP,0,50\nFIC1.OP,4,51\nFIC1.OP,6,52\n"
    loop = read_loop(write(text))
    assert loop.t.tolist() == [0, 2, 4, 6]
    assert np.array_equal(loop.pv, [np.nan, 1, 3, np.nan], equal_nan=True)
    assert loop.good.tolist() == [False, True, True, False]


def test_a_state_is_not_bridged(write):
    text = (
        "tag,time,value\nFIC1.PV,0,1\nFIC1.PV,2,Bad Input\nFIC1.PV,4,3\n"
        "FIC1.OP,0,50\nFIC1.OP,1,50\nFIC1.OP,2,I/O Timeout\nFIC1.OP,3,50\nFIC1.OP,4,50\n"
    )
    loop = read_loop(write(text))
    assert loop.log.good("PV").tolist() == [True, False, False, False, True]
    assert loop.log.good("OP").tolist() == [True, True, False, True, True]


def test_bad_quality_is_kept_with_its_value(write):
    text = "tag,time,value,quality\nPV,0,1,Good\nPV,1,2,Bad\nOP,0,50,Good\nOP,1,50,Good\n"
    loop = read_loop(write(text))
    assert loop.pv.tolist() == [1, 2]
    assert loop.good.tolist() == [True, False]


def test_modes_in_a_long_table(write):
    text = "tag,time,value\n" + "".join(
        f"FIC1.PV,{i},{i}\nFIC1.OP,{i},50\n" + (f"FIC1.MODE,{i},{mode}\n" if mode else "")
        for i, mode in enumerate(["MAN", "", "AUTO", "", "CAS"])
    )
    loop = read_loop(write(text))
    assert loop.mode.tolist() == [0, 0, 1, 1, 2]
    assert loop.good.tolist() == [False, False, True, True, True]


def test_all_tags_of_a_long_table(write):
    text = "tag,time,value\nA,0,1\nB,0,2\nremark,0,start\nA,1,3\nB,1,4\n"
    log = read_log(write(text))
    assert log.names == ("A", "B")
    assert log["B"].tolist() == [2, 4]
    assert any("'remark' holds no number" in note for note in log.notes)


def test_repeated_rows_of_one_tag(write):
    text = "tag,time,value\nPV,0,1\nPV,0,1\nOP,0,50\nPV,1,2\nOP,1,51\n"
    loop = read_loop(write(text))
    assert loop.pv.tolist() == [1, 2]
    assert "PV: 1 repeated row dropped." in loop.notes
