"""Positioner and actuator: the inner loop in closed form, located edges, and what it makes of a sticky stem."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.ideal_valve import IdealValve
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.positioner import Positioner
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.sources import Constant, Step
from stickslip.blocks.stick_slip import StickSlip
from stickslip.blocks.stribeck_stem import StribeckStem
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference

SHARP = {"rtol": 1e-9, "atol": 1e-11}
K, F_C, F_S = 52500.0, 1250.0, 1750.0


def valve(OP, stem, **settings):
    return wire([OP, Positioner(**settings), stem])


def test_the_inner_loop_is_a_lag_outside_its_dead_band():
    run = simulate(valve(Step("OP", 0.3), IdealValve(inputs="p"), G=2.0, band=0.02, r_fill=math.inf), 5.0, **SHARP)
    np.testing.assert_allclose(run.log["MV"], 0.29 * (1 - np.exp(-2 * run.log.t)), atol=1e-7)  # analytic
    assert [e.after for e in run.events] == ["filling"] and run.statistics.steps < 60


def test_full_rate_then_the_lag():
    # analytic: ramp 0.1 t until G (e - band/2) = 0.1, that is p = 0.4 - 0.05, then a lag from there
    run = simulate(valve(Step("OP", 0.4), IdealValve(inputs="p"), G=2.0, band=0.0, r_fill=0.1), 8.0, **SHARP)
    t = run.log.t
    expected = np.where(t < 3.5, 0.1 * t, 0.4 - 0.05 * np.exp(-2 * (t - 3.5)))
    np.testing.assert_allclose(run.log["MV"], expected, atol=1e-7)
    assert [(e.t, e.after) for e in run.events][:3] == [
        (0.0, "filling"), (0.0, "filling at full rate"), (pytest.approx(3.5, abs=1e-7), "filling")
    ]  # fmt: skip


def test_it_holds_within_its_band():
    OP = Staircase("OP", [0.5, 0.504, 0.496], dwell=10.0)
    run = simulate(valve(OP, IdealValve(inputs="p"), band=0.01, start=0.5), 30.0, every=1.0)
    assert run.events == () and np.all(run.log["MV"] == 0.5)


def test_a_stuck_stem_is_pushed_until_it_breaks_away():
    run = simulate(valve(Step("OP", 0.5), StickSlip(F_S, F_C, inputs="p"), r_fill=0.02), 5.0, **SHARP)
    slip = next(e.t for e in run.events if e.after == "sliding up")
    assert slip == pytest.approx(F_S / K / 0.02, rel=1e-6)  # analytic: k p = F_s, p = r_fill t


def test_supply_and_exhaust_end_the_push():
    stuck = StickSlip(1e5, F_C, inputs="p")
    OP = Staircase("OP", [1.0, -1.0, 0.0], dwell=20.0)
    run = simulate(valve(OP, stuck, r_fill=0.2, r_vent=0.4), 60.0, **SHARP)
    ends = {e.after: e.t for e in run.events}
    assert ends["at supply pressure"] == pytest.approx(6.0, abs=1e-7)  # analytic: 1.2/0.2
    assert ends["at exhaust pressure"] == pytest.approx(20.0 + 1.4 / 0.4, abs=1e-7)
    assert run.log["p"].max() == 1.2 and run.log["p"].min() == -0.2
    assert run.events[-1].after == "holding"


def test_it_removes_the_offset_of_friction_up_to_its_band():
    for OP in (0.3, 0.6):
        bare = drive(StickSlip(F_S, F_C, start=0.1), 60.0, every=60.0, OP=OP).log["MV"][-1]
        run = simulate(
            valve(Constant("OP", OP), StickSlip(F_S, F_C, start=0.1, inputs="p"), start=0.1), 60.0, every=1.0
        )
        assert abs(bare - OP) == pytest.approx(F_C / K, abs=1e-4)  # analytic
        assert abs(run.log["MV"][-1] - OP) <= 0.0025 + (F_S - F_C) / K


def hunting(band):
    stem = StribeckStem(F_S, F_C, v_s=1e-3, start=0.5, inputs="p")
    OP = Staircase("OP", [0.5, 0.55], dwell=20.0)
    return simulate(valve(OP, stem, band=band, start=0.5), 600.0, every=0.5)


def test_a_dead_band_wider_than_the_jump_ends_the_hunting():
    # the positioner integrates, so a stem that jumps by J never rests within a band that is narrower
    narrow, wide = hunting(0.5 * (F_S - F_C) / K), hunting(1.3 * (F_S - F_C) / K)
    late = narrow.log.t > 300.0
    assert narrow.ok and wide.ok
    assert np.ptp(narrow.log["MV"][late]) > 0.5 * (F_S - F_C) / K and np.ptp(wide.log["MV"][late]) == 0.0


def loop():
    return wire([Step("SP", 0.5), PI(0.4, 10.0), Positioner(), StickSlip(F_S, F_C, inputs="p"), FirstOrder(3.0, 10.0)])


def test_a_loop_costs_few_steps_and_the_reference_agrees():
    run = simulate(loop(), 600.0)
    assert run.ok and run.statistics.steps < 400
    ours = simulate(loop(), 60.0, every=1.0, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(loop(), 60.0, every=1.0)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-6)


def test_without_friction_it_comes_to_rest_without_chattering():
    for band in (0.0, 0.005):
        parts = [Step("SP", 0.5), PI(0.4, 10.0), Positioner(band=band), IdealValve(inputs="p"), FirstOrder(3.0, 10.0)]
        run = simulate(wire(parts), 600.0)
        assert run.ok and run.statistics.steps < 400


def test_python_control_sees_the_mode_of_the_present_values():
    loop = valve(Step("OP", 0.4), IdealValve(inputs="p"), G=2.0, band=0.02, r_fill=0.1)
    t = np.linspace(0.0, 8.0, 81)
    seen = ct.input_output_response(
        loop, t, 0.0, loop.x0, solve_ivp_method="RK45", solve_ivp_kwargs={"rtol": 1e-8, "max_step": 0.05}
    )
    ours = simulate(loop, 8.0, times=t)
    np.testing.assert_allclose(seen.outputs[list(loop.output_labels).index("MV")], ours.log["MV"], atol=1e-5)
    ends = Positioner(start=1.2).dynamics(0.0, [1.2], [1.5, 0.0])[0], Positioner().dynamics(0.0, [0.0], [-1.0, 0.0])[0]
    assert ends == (0.0, -0.2)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Positioner(G=0.0), "G = 0.0, but it must be positive"),
        (lambda: Positioner(band=-0.1), "band = -0.1, but it must be finite and not negative"),
        (lambda: Positioner(r_vent=0.0), "r_vent = 0.0, but air flows at a positive rate"),
        (lambda: Positioner(exhaust=2.0, start=2.0, supply=2.0), "exhaust = 2.0, but it must be below supply = 2.0"),
        (lambda: Positioner(start=3.0), "start = 3.0, but pressure lies between exhaust"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()
