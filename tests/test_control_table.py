"""The table of docs/python_control.md names every block and says what python-control's simulator makes of it."""

import importlib.util
import re
import warnings
from pathlib import Path

import control as ct
import pytest
from stickslip.detect import blocks as detectors
from stickslip.diagram import unseen

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


def test_slopes_warn_of_nothing(monkeypatch):
    monkeypatch.setattr(unseen, "WARNED", set())
    with warnings.catch_warnings():
        warnings.simplefilter("error", unseen.UnseenWarning)
        diagram = control_table.TRIALS["RelayTuner"].diagram()
        ct.linearize(diagram, diagram.x0)
        noisy = control_table.TRIALS["SampledSensor"].diagram()
        ct.linearize(noisy.cut("PV"), noisy.cut("PV").x0, [0.5])
