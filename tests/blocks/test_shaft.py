"""Shaft: torque balance."""

import numpy as np
import pytest
from stickslip.blocks.ports import BlockError
from stickslip.blocks.shaft import Shaft
from stickslip.diagram import drive


def test_torque_balance():
    shaft = Shaft(20.0, start=1000.0, loads=["a", "b", "c"])
    assert shaft.dynamics(0.0, shaft.x0, [100.0, 20.0, 30.0, 10.0])[0] == pytest.approx(2.0, rel=1e-14)  # analytic


def test_surplus_torque_speeds_it_up():
    run = drive(Shaft(5.0, start=100.0), 10.0, every=1.0, tau_d=30.0, tau=20.0)
    np.testing.assert_allclose(run.log["w"], 100.0 + 2.0 * run.log.t, rtol=1e-9)  # analytic


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"J = 0.0, but an inertia is positive; give kg m2"):
        Shaft(0.0, start=1.0)
    with pytest.raises(BlockError, match=r"start = 0.0"):
        Shaft(start=0.0)
    with pytest.raises(BlockError, match=r"a shaft turns something"):
        Shaft(start=1.0, loads=[])
    with pytest.raises(BlockError, match=r"the loads are wired"):
        Shaft(start=1.0).with_params(loads=3)


def test_one_load_may_be_named_without_a_list():
    assert Shaft(start=994.838, loads="tau_2").input_labels == ["tau_d", "tau_2"]
