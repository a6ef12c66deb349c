"""Column names of the usual systems."""

import pytest
from stickslip.logs import ReadError, read_log, read_loop
from stickslip.logs.files.columns import choose_columns
from stickslip.logs.files.grouping import Columns, loop_names
from stickslip.logs.files.names import role_of

NAMES = {
    "SP": ("FIC211.SP", "FIC211.PIDA.SP", "PID1/SP.CV", "FIC-211 Sp", "12-FIC-211_SP", "SetPoint", "LIC7 setpoint",
           "FIC211:SV", "Set Point", "UNIT.FIC211.SP"),
    "PV": ("FIC211.PV", "FIC211.PIDA.PV", "PID1/PV.CV", "TIC_1203A_PV", "Process Value", "FIC211PV", "PV_FIC211",
           "pv", "LIC7 Measurement", "UNIT.FIC211.PV.Value", "y"),
    "OP": ("FIC211.OP", "FIC211.PIDA.OP", "PID1/OUT.CV", "FIC-211 OP", "FIC211_CO", "controller output", "Output",
           "ControllerOutput", "FIC211.OUT", "u", "OP FIC211"),
    "MV": ("FIC211.MV", "MV", "manipulated variable"),
    "STEM": ("stem", "Valve Position", "FV211 position feedback", "FV211.ZT", "stem_position"),
    "MODE": ("FIC211.MODE", "MODE", "PID1/MODE.ACTUAL", "FIC211_Mode", "FIC211.MODE.CV"),
}  # fmt: skip


@pytest.mark.parametrize(("role", "name"), [(role, name) for role, names in NAMES.items() for name in names])
def test_roles_by_name(role, name):
    known = role_of(name)
    assert known is not None
    assert known[1] == role


@pytest.mark.parametrize(
    "name", ["flow_t_h", "P1_kPa", "input", "remark", "PID1/MODE.TARGET", "speed_rpm", "FT211", "T", "supply"]
)
def test_other_names_tell_nothing(name):
    assert role_of(name) is None


def test_loops_are_listed_in_order():
    names = ["LIC2.PV", "FIC1.OP", "FIC1.PV", "LIC2.OP", "TI5.PV"]
    assert loop_names(names) == ("LIC2", "FIC1")


TWO = "time,FIC1.PV,FIC1.OP,LIC2.PV,LIC2.SP,LIC2.OP\n0,1,51,3,4,55\n1,1,51,3,4,55\n"


@pytest.mark.parametrize("asked", ["LIC2", "lic2", "LIC-2"])
def test_a_loop_is_chosen_by_its_tag(write, asked):
    loop = read_loop(write(TWO), loop=asked)
    assert (loop.name, loop.pv[0], loop.op[0], loop.sp[0]) == ("LIC2", 3, 55, 4)
    assert loop.process == "integrating"


def test_a_named_column_tells_the_loop(write):
    loop = read_loop(write(TWO), pv="FIC1.PV")
    assert (loop.name, loop.op[0], loop.sp) == ("FIC1", 51, None)


def test_mv_is_the_output_where_there_is_no_other(write):
    loop = read_loop(write("time,FIC1.PV,FIC1.MV\n0,1,51\n1,2,52\n"))
    assert loop.op.tolist() == [51, 52]
    assert loop.mv is None
    assert any("'FIC1.MV' is taken as OP" in note for note in loop.notes)


def test_mv_is_the_stem_beside_an_output(write):
    loop = read_loop(write("time,PV,OP,MV\n0,1,51,50\n1,2,52,50\n"))
    assert loop.mv.tolist() == [50, 50]
    assert loop.log.spans["MV"] == (0, 100)
    assert any("'MV' is taken as the stem position" in note for note in loop.notes)


def test_mv_beside_a_stem_is_the_output(write):
    loop = read_loop(write("time,PV,MV,Valve Position\n0,1,51,49\n1,2,52,49\n"))
    assert (loop.op[0], loop.mv[0]) == (51, 49)


def test_a_signal_can_be_left_out(write):
    loop = read_loop(write("time,SP,PV,OP\n0,5,4,50\n1,5,4,50\n"), sp="")
    assert loop.sp is None
    assert "SP is not logged: e = SP - PV is not known." in loop.notes


def test_tags_that_differ_make_one_loop_if_alone(write):
    loop = read_loop(write("time,FT211.PV,FIC211.OP\n0,1,51\n1,2,52\n"))
    assert loop.name == "FIC211"
    assert any("different tags" in note for note in loop.notes)


def test_tags_that_differ_are_not_mixed_up():
    with pytest.raises(ReadError, match=r"several columns may be the PV .*'FT1.PV', 'FT2.PV'"):
        choose_columns(Columns(["FT1.PV", "FT2.PV", "FV9.OP"]))


def test_interpreted_names_are_noted(write):
    notes = read_loop(write("time,PID1/PV.CV,PID1/OUT.CV\n0,1,51\n1,2,52\n")).notes
    assert "'PID1/OUT.CV' is read as OP." in notes


STEMS = [
    "FIC101.POS",
    "FV101.POS",
    "FV-101 position",
    "ZT101",
    "ZT-101.PV",
    "12-ZI-101",
    "FIC101.ZT",
    "FV101.MV",
    "stem",
]


@pytest.mark.parametrize("stem", STEMS)
def test_a_logged_stem_is_found_under_a_tag_of_its_own(write, stem):
    loop = read_loop(write(f"time,FIC101.PV,FIC101.OP,{stem}\n0,1,51,49\n1,2,52,49\n"))
    assert (loop.op[0], loop.mv[0]) == (51, 49)
    assert f"{stem!r} is read as MV." in loop.notes


def test_the_stem_of_another_valve_is_not_taken(write):
    loop = read_loop(write("time,FIC101.PV,FIC101.OP,ZT101,ZT205\n0,1,51,49,7\n1,2,52,49,7\n"))
    assert loop.mv[0] == 49
    loop = read_loop(write("time,FIC101.PV,FIC101.OP,ZT205\n0,1,51,7\n1,2,52,7\n"))
    assert loop.mv is None
    assert any("'ZT205' (stem position of ZT205; name it with mv= (--mv)" in note for note in loop.notes)


def test_the_stem_beside_columns_named_by_the_user(write):
    path = write("time,FT101,FCV101,ZT101\n0,1,51,49\n1,2,52,49\n")
    assert read_loop(path, pv="FT101", op="FCV101").mv[0] == 49


def test_readback_and_manipulated_variable_of_pcs7(write):
    loop = read_loop(write("time,FIC1.PV#Value,FIC1.MV#Value,FIC1.Rbk#Value\n0,1,51,49\n1,2,52,49\n"))
    assert (loop.op[0], loop.mv[0]) == (51, 49)


@pytest.mark.parametrize("name", ["FIC1_SET", "FIC1.SET", "FIC1 Sollwert", "Consigna FIC1"])
def test_set_points_of_other_names(write, name):
    assert read_loop(write(f"time,FIC1.PV,FIC1.OP,{name}\n0,1,51,4\n1,2,52,4\n")).sp[0] == 4


def test_columns_without_a_tag_are_the_only_loops(write):
    loop = read_loop(write("time,FIC1.PV,FIC1.OP,SP,MODE\n0,1,51,4,AUTO\n1,2,52,4,AUTO\n"))
    assert (loop.sp[0], loop.mode[0]) == (4, 1)


def test_every_column_not_used_is_named_with_its_reason(write):
    text = (
        "time,timestamp,FIC1.PV,FIC1.OP,FIC1.OUT,LIC2.PV,LIC2.PV.Quality,remark,T7\n"
        "0,00:00:00,1,51,51,9,Good,x,3\n1,00:00:01,2,52,52,9,Good,,3\n"
    )
    note = next(note for note in read_loop(write(text), loop="FIC1").notes if "not used" in note)
    assert note == (
        "Columns not used: 'timestamp' (the time is 'time'), 'FIC1.OUT' (OP is 'FIC1.OP'), 'LIC2.PV' (PV of LIC2), "
        "'remark', 'T7' (no part of the loop by name), "
        "'LIC2.PV.Quality' (quality of 'LIC2.PV')."
    )


def test_columns_left_out_as_told_and_tags_are_named_too(write):
    notes = read_loop(write("time,SP,PV,OP\n0,5,4,50\n1,5,4,50\n"), sp="").notes
    assert "Columns not used: 'SP' (left out as asked)." in notes
    notes = read_loop(write("tag,time,value\nPV,0,1\nOP,0,50\nTI7.PV,0,3\nPV,1,1\nOP,1,50\nTI7.PV,1,3\n")).notes
    assert any("Columns not used: 'TI7.PV' (PV of TI7)" in note for note in notes)


def test_nothing_unused_is_nothing_said(write):
    notes = read_loop(write("time,SP,PV,OP,MODE,PV.quality\n0,5,4,50,AUTO,Good\n1,5,4,50,AUTO,Good\n")).notes
    assert not any("not used" in note for note in notes)


def test_hundreds_of_columns_do_not_flood_the_notes(write):
    head, row = ",".join(f"TI{i}.PV" for i in range(400)), ",".join("1" for _ in range(400))
    note = next(n for n in read_loop(write(f"time,FIC1.PV,FIC1.OP,{head}\n0,1,50,{row}\n")).notes if "not used" in n)
    assert note.endswith("and 385 more.") and len(note) < 700


@pytest.mark.parametrize("other", ["XV101.POS", "HV-101 position", "13-ZT-101", "ZT102"])
def test_other_valves_are_not_the_stem(write, other):
    loop = read_loop(write(f"time,12-FIC-101.PV,12-FIC-101.OP,{other}\n0,1,51,49\n1,2,52,49\n"))
    assert loop.mv is None


def test_a_signal_may_have_a_name_that_times_have(write):
    path = write("time,T,hours,OP\n0,80,7,50\n1,81,7,51\n2,82,7,50\n")
    assert read_loop(path, pv="T").pv.tolist() == [80, 81, 82]
    assert read_log(path).names == ("T", "hours", "OP")
