"""Relay with hysteresis: located switching, limit cycles in closed form."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Triangle
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.relay import Relay
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference
from stickslip.engine.status import Status


def test_it_switches_at_its_thresholds():
    run = drive(Relay("y", "u", 0.5, -0.25, high=3.0, low=-2.0), 16.0, every=0.5, u=Triangle("u", 1.0, 8.0))
    # analytic: a triangle of slope 1/2 from 0
    assert [e.t for e in run.events] == pytest.approx([1.0, 4.5, 9.0, 12.5], abs=1e-9)
    assert set(run.log["y"]) == {3.0, -2.0}
    assert run.log["y"][:4].tolist() == [-2.0, -2.0, 3.0, 3.0]


def test_jumps_switch_it_at_once():
    run = drive(Relay("y", "u", 0.5), 5.0, every=1.0, u=Staircase("u", [0.0, 2.0, 0.5, 0.4, 3.0], dwell=1.0))
    assert run.log["y"].tolist() == [0.0, 1.0, 1.0, 0.0, 1.0, 1.0]


def heater(e=0.05):
    # on below 0.5 - e, off above 0.5 + e: low is above high
    return wire([Relay("MV", "PV", 0.5 + e, 0.5 - e, high=0.0, low=1.0), FirstOrder(K=0.8, tau=10.0)])


def test_two_position_control_of_a_first_order_process():
    e = 0.05
    run = simulate(heater(e), 200.0, every=1.0, rtol=1e-9, atol=1e-11)
    # analytic: tau ln of the ratio of distances to 0.8 (heating) and to 0 (cooling)
    up, down = 10 * math.log((0.3 + e) / (0.3 - e)), 10 * math.log((0.5 + e) / (0.5 - e))
    times = np.array([ev.t for ev in run.events])
    assert times[0] == pytest.approx(10 * math.log(0.8 / (0.3 - e)), abs=1e-7)
    np.testing.assert_allclose(np.diff(times)[::2], down, atol=1e-7)
    np.testing.assert_allclose(np.diff(times)[1::2], up, atol=1e-7)
    assert run.statistics.steps < 12 * len(run.events)


def test_the_reference_agrees():
    ours = simulate(heater(), 60.0, every=0.6, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(heater(), 60.0, every=0.6)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-8)
    np.testing.assert_allclose([e.t for e in ours.events], [e.t for e in theirs.events], atol=1e-7)


def test_limit_cycle_with_an_integrator():
    # analytic: PV goes back and forth by 2 e at the rate K: period 4 e/K
    run = simulate(wire([Relay("MV", "PV", 0.1, -0.1, high=-1.0, low=1.0), Integrator(0.5)]), 20.0)
    assert np.diff([ev.t for ev in run.events]) == pytest.approx(0.4)
    # half a period is 2 e/K = 0.4 s


def test_without_hysteresis_the_loop_says_that_it_chatters():
    run = simulate(wire([Relay("MV", "PV", 0.5, high=0.0, low=1.0), FirstOrder(K=0.8, tau=10.0)]), 20.0)
    assert run.status is Status.CHATTERING and "MV" in run.hint
    assert run.statistics.steps < 1000  # it is found out at once


def test_python_control_sees_the_hysteresis():
    relay = Relay("y", "u", 0.5, -0.5, high=2.0, on=True)
    seen = ct.input_output_response(relay, [0.0, 1.0, 2.0], [-1.0, 0.0, 1.0])
    assert seen.outputs.tolist() == [0.0, 0.0, 2.0]  # analytic: off at -1, and still at 0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Relay("y", "u", 0.5, 0.6), r"switch_off = 0.6, but it switches off at or below .* switch_on = 0.5"),
        (lambda: Relay("y", "u", math.inf), "switch_on = inf, but it must be a finite number"),
        (lambda: Relay("y", "u", 0.5, high=math.nan), "high = nan"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()
