"""Valve body: square root, laminar middle, check valve."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.control_valve_flow import ControlValveFlow, drop_for, root
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Ramp
from stickslip.diagram import drive


@given(st.floats(1e3, 1e8))
def test_turbulent_flow_is_the_square_root(drop):
    assert root(drop, 100.0) == pytest.approx(math.sqrt(drop) * (1 + 1e4 / drop**2) ** -0.25, rel=1e-12)  # analytic
    assert root(drop, 0.0) == pytest.approx(math.sqrt(drop), rel=1e-15)


@given(st.floats(-1e8, 1e8), st.sampled_from([0.0, 1.0, 100.0]))
def test_root_is_odd_rising_and_inverted(drop, p_lam):
    assert root(-drop, p_lam) == -root(drop, p_lam)
    if abs(drop) > 1e-3:
        assert root(drop * 1.001, p_lam) * math.copysign(1, drop) > root(drop, p_lam) * math.copysign(1, drop)
        assert drop_for(root(drop, p_lam), p_lam) == pytest.approx(drop, rel=1e-12)


def test_laminar_slope():
    assert root(1e-3, 100.0) / 1e-3 == pytest.approx(1.0 / math.sqrt(100.0), rel=1e-6)  # analytic


def test_printed_sizes():
    # Published: table A.2 sizes VLCS1 for 9500 mol/s at 24 bar, VLCS2 for 9500 at 12 bar.
    assert ControlValveFlow(6.1).output(0.0, [], [24e5, 0.0, 1.0])[0] == pytest.approx(9500.0, rel=0.01)
    assert ControlValveFlow(8.7).output(0.0, [], [12e5, 0.0, 1.0])[0] == pytest.approx(9500.0, rel=0.01)
    # At the 18 bar between the separators VLCS1 passes less; plant notes 1.3.
    assert ControlValveFlow(6.1).output(0.0, [], [18e5, 0.0, 1.0])[0] == pytest.approx(8184.0, rel=1e-4)


def test_stem_below_its_seat_passes_nothing():
    assert ControlValveFlow(6.1).output(0.0, [], [24e5, 0.0, -0.1])[0] == 0.0


def test_check_valve_shuts_at_zero_drop():
    valve = ControlValveFlow(2.0, check_valve=True)
    run = drive(valve, 10.0, every=0.5, p_up=Ramp("p_up", -1e5, before=4e5), p_down=0.0, MV=0.5)
    F, t = run.log["F"], run.log.t
    expected = [root(max(4e5 - 1e5 * s, 0.0), 100.0) for s in t]  # analytic
    np.testing.assert_allclose(F, expected, rtol=1e-9, atol=1e-9)
    assert [(round(e.t, 6), e.before, e.after) for e in run.events] == [(4.0, "open", "shut")]


def test_without_check_valve_it_flows_back():
    run = drive(ControlValveFlow(2.0), 10.0, every=5.0, p_up=Ramp("p_up", -1e5, before=4e5), p_down=0.0, MV=0.5)
    assert run.log["F"][-1] == pytest.approx(-math.sqrt(6e5), rel=1e-6)  # analytic


def test_unit_is_told_to_the_wiring():
    assert ControlValveFlow(0.02, unit="kg/s").units["F"] == "kg/s"


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"C_v = 0.0, but a flow coefficient is positive"):
        ControlValveFlow(0.0)
    with pytest.raises(BlockError, match=r"p_lam = -1.0"):
        ControlValveFlow(1.0, p_lam=-1.0)
