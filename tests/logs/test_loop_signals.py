"""Which signals make up which loop travels with a log: through files, cuts and new names."""

import json
from dataclasses import replace

import numpy as np
import pytest
from stickslip.logs import Log, LogError, LoopSignals, ReadError, read_log, read_loop, read_loops


@pytest.fixture
def plant():
    t = np.arange(30.0)
    names = ("SP_1", "p_1", "u_1", "x_1", "V_1", "u_2", "F_7")
    return Log(
        t, {name: 40.0 + i + np.sin(t + i) for i, name in enumerate(names)},
        units={"p_1": "Pa", "V_1": "m3", "u_1": "%"}, spans={"u_1": (0.0, 100.0), "u_2": (0.0, 1.0)},
        loops={
            "PCS11": LoopSignals("p_1", "u_1", sp="SP_1", mv="x_1", process="self_regulating", measurement="pressure"),
            "LCS11": LoopSignals("V_1", "u_2", process="integrating", measurement="level"),
        },
    )  # fmt: skip


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_file_keeps_the_loops(plant, tmp_path, ending):
    file = tmp_path / f"plant.{ending}"
    getattr(plant, f"to_{ending}")(file)
    assert read_log(file).loops == plant.loops
    pressure, level = read_loops(file)
    assert (pressure.name, level.name) == ("PCS11", "LCS11")
    assert pressure.mv is not None and pressure.sp is not None and level.sp is None
    assert (pressure.process, level.process) == ("self_regulating", "integrating")
    assert (pressure.measurement, level.measurement) == ("pressure", "level")
    assert pressure.op_span == (0.0, 100.0) and level.op_span == (0.0, 1.0)
    assert pressure.pv.tolist() == plant["p_1"].tolist() and level.op.tolist() == plant["u_2"].tolist()
    assert read_loop(file, loop="LCS11").pv.tolist() == plant["V_1"].tolist()
    assert read_loop(file, loop="PCS11", mv="").mv is None  # what the user says goes before it
    with pytest.raises(ReadError, match="2 loops: 'PCS11', 'LCS11'; choose one with loop="):
        read_loop(file)
    with pytest.raises(ReadError, match="no loop 'FIC1'"):
        read_loop(file, loop="FIC1")


def test_a_loop_that_is_not_noted_is_refused_with_the_names_of_those_that_are(plant, tmp_path):
    plant.to_csv(tmp_path / "plant.csv")
    with pytest.raises(ReadError, match=r"no loop 'PCS12' in the file; .*PCS11"):
        read_loop(tmp_path / "plant.csv", loop="PCS12")


def test_the_kind_of_process_can_be_given_for_all_loops(plant, tmp_path):
    plant.to_csv(tmp_path / "plant.csv")
    assert {record.process for record in read_loops(tmp_path / "plant.csv", process="integrating")} == {"integrating"}


def test_records_of_a_log(plant):
    pressure, level = plant.loop_records()
    assert (pressure.name, pressure.sp_name, pressure.mv_name) == ("PCS11", "SP_1", "x_1")
    assert plant.loop(name="LCS11").pv_name == level.pv_name == "V_1"
    assert plant.loop(pv="V_1", op="u_1", name="PCS11").pv_name == "V_1"  # signals that are given go first
    with pytest.raises(LogError, match="no signal 'PV'"):
        replace(plant, loops={}).loop_records()


def test_cuts_and_names_keep_them(plant):
    assert plant.between(3.0, 9.0).loops == plant.loops
    assert plant.renamed({"p_1": "pressure"}).loops["PCS11"].pv == "pressure"
    assert plant.with_signals(p_1=np.zeros(30)).loops == plant.loops


def test_a_loop_of_what_is_not_logged(plant):
    with pytest.raises(LogError, match="mv of loop 'A' is 'zz', which is not logged"):
        replace(plant, loops={"A": LoopSignals("p_1", "u_1", mv="zz")})
    with pytest.raises(LogError, match="a loop needs PV and OP"):
        LoopSignals("", "u")
    with pytest.raises(LogError, match="process = 'odd'"):
        LoopSignals("p", "u", process="odd")


@pytest.mark.parametrize(
    "spoilt", ['"loop"', "5", '{"name": "A"}', '{"name": "A", "pv": "p_1", "op": 5, "process": "x"}']
)
def test_a_spoilt_heading_is_passed_over(plant, tmp_path, spoilt):
    file = tmp_path / "plant.csv"
    plant.to_csv(file)
    whole = file.read_text().split("\n")
    loop = next(i for i, line in enumerate(whole) if line.startswith("# loop"))
    assert json.loads(whole[loop].removeprefix("# loop: "))["name"] == "PCS11"
    whole[loop] = f"# loop: {spoilt}"
    file.write_text("\n".join(whole))
    assert set(read_log(file).loops) == {"LCS11"}


def test_a_log_of_a_foreign_file_notes_the_loops_that_its_tags_tell(tmp_path):
    file = tmp_path / "unit.csv"
    file.write_text("time,FIC1.PV,FIC1.OP,FIC1.SP,TI7.PV,LIC2.PV,LIC2.OP\n0,4,50,4,9,1,20\n1,5,51,4,9,2,21\n")
    log = read_log(file)
    assert log.loops == {
        "FIC1": LoopSignals("FIC1.PV", "FIC1.OP", "FIC1.SP", process="self_regulating", measurement="flow"),
        "LIC2": LoopSignals("LIC2.PV", "LIC2.OP", process="integrating", measurement="level"),
    }
    assert log.spans == {"FIC1.OP": (0.0, 100.0), "LIC2.OP": (0.0, 100.0)}
    assert "FIC1.OP is taken as % of its span (values 50 to 51)." in log.notes


def test_simulation_notes_them():
    from stickslip.diagram import ensemble, simulate
    from stickslip.plant import production_plant

    plant = production_plant()
    log = simulate(plant, 2.0, every=1.0).log
    assert set(log.loops) == {"LCS11", "PCS11", "LCS21", "PCS21", "ASC2", "ASC3", "SC001", "SC002"}
    pressure = log.loops["PCS11"]
    assert pressure.parts == {"sp": "SP_PCS11", "pv": "p_1", "op": "OP_VPCS1", "mv": "MV_VPCS1"}
    assert (pressure.measurement, log.loops["LCS11"].process) == ("pressure", "integrating")
    some = simulate(plant, 2.0, every=1.0, signals=["p_1", "OP_VPCS1"]).log
    assert {tag: loop.parts for tag, loop in some.loops.items()} == {"PCS11": {"pv": "p_1", "op": "OP_VPCS1"}}
    many = ensemble(plant, 2.0, params={"VPCS1.F_s": [0.04]}, every=1.0) if "VPCS1.F_s" in plant.params else None
    assert many is None or set(many.log(0).loops) == set(log.loops)
