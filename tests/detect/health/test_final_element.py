"""Where the log tells that OP moves no valve, every answer is that there is none; elsewhere nothing changes."""

import numpy as np
import pytest
from stickslip.cases import find
from stickslip.detect import diagnose
from stickslip.detect.health.conditions import examine
from stickslip.detect.health.final_element import no_valve
from stickslip.detect.methods import curve_fit
from stickslip.diagram import simulate
from stickslip.logs import Log, LoopSignals, read_loop, read_loops

T = np.arange(400.0)


def record(unit="", mv=None, below=""):
    signals = {"p": np.cos(T / 9), "u": 50 + np.sin(T / 9), "x": np.sin(T / 9)}
    loops = {"SC1": LoopSignals("p", "u", mv=mv, master_of=below)}
    return Log(T, signals, units={"u": unit}, loops=loops).loop_records()[0]


@pytest.mark.parametrize(
    ("unit", "valve"),
    [("rad/s", False), ("rpm", False), ("N m", False), ("m3/h", False), ("degC", False), ("kW", False), ("Hz", False),
     ("%", True), ("", True), ("mA", True), ("bar", True), ("mm", True), ("V", True), ("% open", True)],
)  # fmt: skip
def test_units_of_what_moves_no_valve(unit, valve):
    assert no_valve(record(unit)).present is not valve
    assert not no_valve(record(unit, mv="x")).present  # a logged stem is a valve in any unit


def test_every_method_and_the_verdict_say_so():
    loop = record("rad/s")
    assert next(fact.code for fact in examine(loop) if fact.present) == "no_valve"
    assert curve_fit.detect(loop).code == "no_valve"
    found = diagnose(loop)
    assert found.verdict == "not_applicable" and "no valve in this loop: OP is in rad/s" in found.reason


def test_the_master_of_a_cascade_has_none_from_any_file(tmp_path):
    """What the diagram knows is kept with the log, in files, and in the loop that is cut out of them."""
    log = simulate(find("cascade_flow").build(), 300.0, every=1.0).log
    assert {tag: loop.master_of for tag, loop in log.loops.items() if loop.master_of} == {"cascade/LC": "cascade/FC"}
    log.to_csv(tmp_path / "unit.csv")
    log.to_parquet(tmp_path / "unit.parquet")
    for file in (tmp_path / "unit.csv", tmp_path / "unit.parquet"):
        assert [one.name for one in read_loops(file) if no_valve(one).present] == ["cascade/LC"]
        assert "set point of cascade/FC" in no_valve(read_loop(file, loop="cascade/LC")).text
    assert [one.name for one in log.loop_records() if no_valve(one).present] == ["cascade/LC"]
