"""Sampled PI: its recurrence, its limit dt -> 0, and what it shares with the continuous controller."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.sampled_filter import SampledFilter
from stickslip.blocks.sampled_pi import SampledPI
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}
KINDS = ["none", "conditional", "back_calculation"]


def drive_at(block, times, rtol=1e-6, atol=1e-9, **inputs):
    """Drive one block alone and return its run, logged at the given times."""
    diagram = wire([block], inputs=block.input_labels)
    return simulate(diagram, float(np.max(times)), times=times, inputs=inputs, rtol=rtol, atol=atol)


def recurrence(e, *, K_p, T_i, dt, low, high, anti_windup, T_t):
    """Independent reference: the equations of the page, written for whole arrays of errors."""
    z, OP = 0.0, []
    for error in e:
        v = K_p * error + z
        OP.append(float(np.clip(v, low, high)))
        if anti_windup != "conditional" or not ((v >= high and error > 0) or (v <= low and error < 0)):
            z += dt * K_p * error / T_i
        if anti_windup == "back_calculation":
            z += min(dt / T_t, 1.0) * (OP[-1] - v)
    return OP


@pytest.mark.parametrize("anti_windup", KINDS)
@pytest.mark.parametrize("dt", [0.25, 2.0, 8.0])
def test_it_computes_its_recurrence_and_holds(anti_windup, dt):
    law = {"K_p": 1.5, "T_i": 6.0, "dt": dt, "low": 0.0, "high": 1.0, "anti_windup": anti_windup}
    pi = SampledPI(**law, T_t=4.0)
    k = np.arange(100)
    held = np.sort(np.concatenate([k * dt, (k + 0.4) * dt]))
    run = drive_at(pi, held, SP=Sine("SP", 0.5, 35.3), PV=0.05)
    e = 0.5 * np.sin(2 * np.pi * k * dt / 35.3) - 0.05
    np.testing.assert_allclose(run.log["OP"][::2], recurrence(e, **law, T_t=4.0), atol=1e-12)
    np.testing.assert_array_equal(run.log["OP"][1::2], run.log["OP"][::2])


def test_step_response_is_a_staircase_along_the_continuous_line():
    run = drive(SampledPI(0.4, 10.0, dt=1.0, **WIDE), 30.0, every=1.0, SP=0.5, PV=0.2)
    np.testing.assert_allclose(run.log["OP"], 0.4 * 0.3 * (1 + run.log.t / 10.0), rtol=1e-12)


@pytest.mark.parametrize("anti_windup", ["none", "back_calculation"])
def test_it_approaches_the_continuous_controller_with_first_order(anti_windup):
    signals = {"SP": Sine("SP", 0.5, 31.4), "PV": 0.0}
    law = {"K_p": 1.5, "T_i": 6.0, "anti_windup": anti_windup}
    times = np.arange(1, 51) * 1.6
    exact = drive_at(PI(**law), times, rtol=1e-10, atol=1e-12, **signals).log["OP"]
    errors = [
        np.sqrt(np.mean((drive_at(SampledPI(**law, dt=dt), times, **signals).log["OP"] - exact) ** 2))
        for dt in (0.1, 0.05, 0.025, 0.0125)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(orders - 1.0) < 0.15), orders  # analytic: first order


def test_conditional_integration_also_approaches_the_riding_controller():
    signals = {"SP": Sine("SP", 0.3, 20.0), "PV": 0.0}
    law = {"K_p": 2.0, "T_i": 5.0, "anti_windup": "conditional"}
    times = np.arange(1, 11) * 1.0
    run = drive_at(PI(**law), times, **signals)
    assert any(e.after == "riding high limit" for e in run.events)
    for dt in (0.1, 0.01, 0.001):
        sampled = drive_at(SampledPI(**law, dt=dt), times, **signals)
        # at the limit the sampled switch errs by up to one sample of either mode, K_p max(|e'|, |e| / T_i) dt
        assert np.max(np.abs(sampled.log["OP"] - run.log["OP"])) < 2.0 * (0.3 * 2 * np.pi / 20 + 0.3 / 5) * 3 * dt


def test_windup_in_discrete_time():
    # e = 0.5 for 100 scans, then -0.1; K_p = 1, T_i = 10, dt = 1
    SP = Staircase("SP", [0.5, -0.1], dwell=100.0)
    OP = {
        kind: drive(SampledPI(1.0, 10.0, dt=1.0, anti_windup=kind), 600.0, every=1.0, SP=SP, PV=0.0).log["OP"]
        for kind in KINDS
    }
    assert np.flatnonzero(OP["none"][100:] < 1.0 - 1e-9)[0] == 391  # z = 5 - 0.01 k, v < 1 once k > 390
    assert OP["conditional"][100] == pytest.approx(0.4)  # z = 0.5
    assert OP["back_calculation"][100] == pytest.approx(0.9 - 0.5 * 0.9**90)  # (1 - dt / T_t)^k


def test_tracking_faster_than_the_scan_is_deadbeat_not_unstable():
    # z goes to limit - K_p e + dt K_p e / T_i in one scan and stays
    pi = SampledPI(1.0, 10.0, dt=5.0, T_t=0.01)
    run = drive(pi, 100.0, every=5.0, SP=Staircase("SP", [0.9, 0.2], dwell=50.0), PV=0.0)
    assert run.log["OP"][10] == pytest.approx(0.2 + 0.1 + 0.45)


def test_bumpless_start_and_offset():
    pi = SampledPI(2.0, 20.0, dt=1.0, offset=0.5, start_op=0.6, start_error=-0.15)
    OP = drive_at(pi, [0.0, 0.5, 1.5], SP=0.35, PV=0.5).log["OP"]
    assert OP[:2].tolist() == pytest.approx([0.6, 0.6])
    assert OP[2] == pytest.approx(0.6 - 2.0 * 0.15 / 20.0)


def test_alone_it_is_a_genuine_discrete_system_for_python_control():
    pi = SampledPI(1.2, 5.0, dt=0.5, start_op=0.5)
    assert pi.dt == 0.5
    t = np.arange(80) * 0.5
    SP = 0.3 * np.sin(t / 4.0)
    response = ct.input_output_response(pi, t, [SP, 0 * t], [0.5])
    run = drive_at(pi, t, SP=Staircase("SP", SP.tolist(), dwell=0.5), PV=0.0)
    np.testing.assert_allclose(response.outputs[0], run.log["OP"], atol=1e-12)


def test_smooth_twin_has_the_same_settings():
    pi = SampledPI(1.2, 5.0, dt=0.5, action="direct", low=-1.0, high=3.0, anti_windup="conditional", start_op=0.7,
                   name="LC", inputs={"SP": "LSP", "PV": "L"}, outputs="LOP", units={"PV": "m"})  # fmt: skip
    twin = pi.smooth()
    assert isinstance(twin, PI)
    assert (twin.name, twin.input_labels, twin.output_labels) == ("LC", ["LSP", "L"], ["LOP"])
    assert (twin.units, twin.spans, twin.anti_windup) == (pi.units, {"OP": (-1.0, 3.0)}, "conditional")
    for key in ("K_p", "T_i", "low", "high", "action"):
        assert twin.params[key] == pi.params[key]
    assert twin.x0.tolist() == pi.d0.tolist() == [0.7]


@settings(max_examples=60)
@given(
    K_p=st.floats(0.05, 20.0),
    T_i=st.floats(0.5, 200.0),
    dt=st.floats(0.05, 10.0),
    anti_windup=st.sampled_from(KINDS),
    action=st.sampled_from(["reverse", "direct"]),
    e=st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=30),
)
def test_op_never_leaves_its_limits_and_a_step_never_changes_its_inputs(K_p, T_i, dt, anti_windup, action, e):
    pi = SampledPI(K_p, T_i, dt=dt, low=-0.2, high=0.7, action=action, anti_windup=anti_windup)
    memory = pi.d0
    for error in e:
        u = np.array([error, 0.0])
        kept = memory.copy()
        OP = pi.output(0.0, memory, u)[0]
        after = pi.dynamics(0.0, memory, u)
        assert -0.2 <= OP <= 0.7
        np.testing.assert_array_equal(memory, kept)
        assert u.tolist() == [error, 0.0]
        memory = after


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SampledPI(1.0, 5.0, dt=0.0), ["dt = 0.0", "positive"]),
        (lambda: SampledPI(0.0, 5.0, dt=1.0), ["K_p = 0.0", "positive"]),
        (lambda: SampledPI(1.0, 5.0, dt=1.0, start_op=-0.1), ["start_op = -0.1", "within"]),
        (lambda: SampledPI(1.0, 5.0, dt=1.0).with_params(dt=-1.0), ["dt = -1.0", "positive"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)


def test_the_integral_may_take_in_the_present_error_first():
    e = [0.1, 0.3, -0.2, 0.0]
    held = (np.arange(4.0), np.array(e))
    from stickslip.blocks import Recorded
    from stickslip.diagram import simulate, wire

    for integral, before in (("previous", 1), ("present", 0)):
        pi = SampledPI(0.4, 10.0, dt=1.0, low=-9.0, high=9.0, integral=integral)
        sources = [Recorded("SP", *held, hold="previous"), Recorded("PV", [0.0], [0.0], hold="previous")]
        log = simulate(wire([*sources, pi]), 3.0, every=1.0).log
        taken = np.concatenate([np.zeros(before), np.cumsum(e)])[:4]
        np.testing.assert_allclose(log["OP"], 0.4 * np.array(e) + 0.04 * taken, atol=1e-12)  # analytic
    with pytest.raises(BlockError, match="integral = 'next'"):
        SampledPI(0.4, 10.0, dt=1.0, integral="next")
    with pytest.raises(BlockError, match=r"present = 0\.5, but it is 0"):
        SampledPI(0.4, 10.0, dt=1.0).with_params(present=0.5)


def test_present_integral_with_back_calculation_at_once_is_the_velocity_form() -> None:
    errors = np.array([0.3, 0.9, 0.9, 0.9, -0.2, -0.8, -0.9, 0.1])
    K_p, T_i, dt, OP, before, expected = 0.7, 4.0, 1.0, 0.0, 0.0, []
    for e in errors:  # analytic: the formula of the page
        OP = min(max(OP + K_p * (e - before) + dt * K_p * e / T_i, 0.0), 1.0)
        expected.append(OP)
        before = e
    controller = SampledPI(K_p, T_i, dt=dt, integral="present", T_t=dt)
    times = np.arange(len(errors), dtype=float)
    run = drive_at(controller, times, SP=(times, errors), PV=0.0)
    assert np.allclose(run.log["OP"], expected, atol=1e-12)
    assert {0.0, 1.0} < set(expected)  # both limits were met


def test_a_filter_and_a_sum_in_front_make_the_series_form_of_a_pid() -> None:
    K_p, T_i, T_d, T_f, dt = 0.4, 10.0, 3.0, 1.5, 0.5
    loop = wire(
        [
            SampledFilter("PV_f", "PV", T_f, dt),
            Sum("PV_d", {"PV": 1 + T_d / T_f, "PV_f": -T_d / T_f}),
            SampledPI(K_p, T_i, dt=dt, action="direct", **WIDE, inputs=["SP", "PV_d"], outputs="OP"),
        ],
        inputs=["SP", "PV"],
    )
    times = dt * np.arange(40)
    run = simulate(loop, times[-1], times=times, inputs={"SP": 0.0, "PV": (times, np.sin(0.3 * times))})
    f, z, expected = 0.0, 0.0, []
    for PV in np.sin(0.3 * times):  # analytic: rate before reset
        f += (1 - math.exp(-dt / T_f)) * (PV - f)
        e = PV + T_d * (PV - f) / T_f
        expected.append(K_p * e + z)
        z += dt * K_p * e / T_i
    assert np.allclose(run.log["OP"], expected, atol=1e-9)
