"""Column names of the usual systems."""

import pytest

from records import ReadError, read_loop
from records.columns import choose_columns, loop_names
from records.names import role_of

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
    told = role_of(name)
    assert told is not None
    assert told[1] == role


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
        choose_columns(["FT1.PV", "FT2.PV", "FV9.OP"])


def test_interpreted_names_are_noted(write):
    notes = read_loop(write("time,PID1/PV.CV,PID1/OUT.CV\n0,1,51\n1,2,52\n")).notes
    assert "'PID1/OUT.CV' is read as OP." in notes
