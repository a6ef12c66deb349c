"""The table of docs/python_control.md names every block and says what python-control's simulator makes of it."""

import importlib.util
import re
import warnings
from pathlib import Path

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, ChoudhuryValve, FirstOrder, HeValve, Step
from stickslip.detect import blocks as detectors
from stickslip.diagram import simulate, unseen, wire
from stickslip.logs.oscillation import oscillation

from stickslip.commands.blocks import BLOCKS

PAGE = Path(__file__).parents[1] / "docs" / "python_control.md"
SPEC = importlib.util.spec_from_file_location("control_table", PAGE.with_name("control_table.py"))
control_table = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(control_table)
ROWS = {
    name: (moves, slopes, difference)
    for name, moves, slopes, difference in re.findall(
        r"^\| (\w+) \| (yes|no) \| (.*?) \| (.*?) \|$", PAGE.read_text(), re.M
    )
}
LARGE = {"Noise"}  # of which python-control cannot see something


def number(cell):
    return float(cell.removeprefix("< "))


def test_every_block_has_a_row():
    assert set(ROWS) == {name for group in BLOCKS.values() for name in group} | set(detectors.__all__)
    assert set(control_table.TRIALS) == set(ROWS)


@pytest.mark.parametrize("name", control_table.TRIALS)
def test_the_row_is_what_happens(name):
    _, moves, slopes, difference = control_table.seen(control_table.TRIALS[name]).cells(name)
    assert (moves, slopes) == ROWS[name][:2], "run python docs/control_table.py"
    shown, now = number(ROWS[name][2]), number(difference)  # snapshot; solvers differ a little between machines
    assert shown / 3.5 < now < 3.5 * shown or max(shown, now) < 2e-5, "run python docs/control_table.py"


def test_what_stands_still_or_differs_is_known_and_warned_of():
    assert {name for name, row in ROWS.items() if row[0] == "no"} == {"Constant", "Historian", "Noise"}
    assert {name for name, row in ROWS.items() if number(row[2]) > 0.1} == LARGE
    assert all(control_table.TRIALS[name].block().unseen() for name in LARGE)


def test_a_warning_comes_once_for_each_kind_of_block(monkeypatch):
    monkeypatch.setattr(unseen, "WARNED", set())

    def warned(diagram):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            ct.input_output_response(diagram, [0.0, 1.0], 0, diagram.x0)
        return [str(each.message) for each in caught if each.category is unseen.UnseenWarning]

    noisy = control_table.TRIALS["Noise"].diagram()
    (said,) = warned(noisy)
    assert "Noise 'out'" in said and "stickslip.diagram.simulate" in said
    assert warned(noisy) == []
    (said,) = warned(control_table.TRIALS["LuGreStem"].diagram())
    assert "the end stops of LuGreStem 'valve'" in said
    assert warned(control_table.TRIALS["StickSlip"].diagram()) == []  # nothing is lost


@pytest.mark.parametrize("valve", [ChoudhuryValve(0.05, 0.02, 0.5), HeValve(0.03, 0.01, 0.5)], ids=["Choudhury", "He"])
def test_a_sampled_valve_cycles_in_a_loop_where_no_step_is_longer_than_its_period(valve, monkeypatch):
    monkeypatch.setattr(unseen, "WARNED", set())
    parts = [Step("SP", 0.2, before=0.15, at=20.3), PI(K_p=1.5, T_i=6.0), valve, FirstOrder(1.0, 10.0)]
    loop = wire(parts, outputs=["PV"])
    ours = simulate(loop, 600.0, every=0.1).log
    late = ours.t > 250.0
    with pytest.warns(unseen.UnseenWarning, match="max_step': 0.5"):
        seen = ct.input_output_response(loop, ours.t, 0, loop.x0, solve_ivp_kwargs={"max_step": 0.5})
    mine, theirs = (oscillation(ours.t[late], np.asarray(pv)[late]) for pv in (ours["PV"], np.ravel(seen.outputs)))
    assert theirs.amplitude == pytest.approx(mine.amplitude, rel=0.3)
    assert theirs.period == pytest.approx(mine.period, rel=0.5), "of its kind, not the same"


def test_slopes_warn_of_nothing(monkeypatch):
    monkeypatch.setattr(unseen, "WARNED", set())
    with warnings.catch_warnings():
        warnings.simplefilter("error", unseen.UnseenWarning)
        diagram = control_table.TRIALS["RelayTuner"].diagram()
        ct.linearize(diagram, diagram.x0)
        noisy = control_table.TRIALS["SampledSensor"].diagram()
        ct.linearize(noisy.cut("PV"), noisy.cut("PV").x0, [0.5])
