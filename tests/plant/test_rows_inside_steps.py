"""Log rows that lie inside a long stiff step are as exact as the step's end."""

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.cases.plant_models import full_plant
from stickslip.diagram import simulate
from stickslip.gap.records.model import silenced

SIGNALS = ["tau_d", "p_in3", "p_1"]


def run(rtol: float):
    """Return 600 s of the undisturbed plant whose set point of pressure switches at 100 and 400 s."""
    plant = silenced(full_plant())
    rest = plant["SP_PCS21"].params["value"]
    moved = Staircase("SP_PCS21", np.array([1.0, 1.01, 0.99]) * rest, at=[0.0, 100.0, 400.0])
    found = simulate(plant.replace("SP_PCS21", moved), 600.0, every=2.0, signals=SIGNALS, rtol=rtol, atol=1e-3 * rtol)
    assert found.ok, found.hint
    return found.log


@pytest.mark.parametrize("rtol", [1e-5, 1e-6])
def test_rows_behind_a_switch_are_as_exact_as_the_tolerance_lets_expect(rtol):
    # expected: the same run by steps so short that each holds few rows; behind the switches the rows were off by up to
    # 34 % (1e-5) and 13 % (1e-6) of the range of the shaft's torque while the steps' ends were right
    exact, found = run(1e-11), run(rtol)
    for s in SIGNALS:
        off = np.abs(found[s] - exact[s]).max() / np.ptp(exact[s])
        assert off < 0.015, f"{s} is off by {off:.2%} of its range"
