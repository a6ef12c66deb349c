"""Continuous PI: analytic responses, windup, exact sliding along a limit, and an independent fine-step reference."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine, Square, Triangle
from stickslip.blocks.pi import PI
from stickslip.blocks.recorded import Recorded, Staircase
from stickslip.blocks.sensor import SampledSensor, Sensor
from stickslip.blocks.sources import Constant, Ramp, Step
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}


def textbook(e, t_end, *, K_p, T_i, low, high, anti_windup, T_t=math.inf, z=0.0, h=2e-4, every=0.5):
    """Independent reference: forward Euler with a tiny step on the equations as the textbooks print them."""
    n, keep = round(t_end / h), round(every / h)
    OP = np.empty(n // keep + 1)
    error = e((np.arange(n + 1) + 1e-9) * h)  # just after the instant, where a step has already happened
    for i in range(n + 1):
        v = K_p * error[i] + z
        op = min(max(v, low), high)
        if i % keep == 0:
            OP[i // keep] = op
        beyond = (v > high and error[i] > 0) or (v < low and error[i] < 0)
        if not (anti_windup == "conditional" and beyond):
            z += h * K_p * error[i] / T_i
        if anti_windup == "back_calculation":
            z += h * (op - v) / T_t
    return OP


def test_step_response_is_a_step_and_a_line():
    run = drive(PI(K_p=0.4, T_i=10.0, **WIDE), 30.0, every=1.0, SP=0.5, PV=0.2)
    np.testing.assert_allclose(run.log["OP"], 0.4 * 0.3 * (1 + run.log.t / 10.0), rtol=1e-9)


def test_ramp_response_is_a_parabola():
    run = drive(PI(K_p=2.0, T_i=5.0, **WIDE), 10.0, every=1.0, SP=Ramp("SP", 0.1), PV=0.0)
    t = run.log.t
    np.testing.assert_allclose(run.log["OP"], 2.0 * 0.1 * (t + t**2 / 10.0), rtol=1e-8, atol=1e-12)


def test_without_integral_time_it_is_a_gain():
    run = drive(PI(K_p=2.0, **WIDE), 10.0, every=1.0, SP=0.3, PV=0.1)
    np.testing.assert_allclose(run.log["OP"], 0.4, rtol=1e-12)


def test_reverse_action_lowers_op_when_pv_rises_and_direct_raises_it():
    for action, sign in (("reverse", -1.0), ("direct", 1.0)):
        run = drive(PI(K_p=0.5, T_i=10.0, action=action, **WIDE), 10.0, every=5.0, SP=0.0, PV=0.2)
        np.testing.assert_allclose(run.log["OP"], sign * 0.1 * (1 + run.log.t / 10.0), rtol=1e-9)


@pytest.mark.parametrize("anti_windup", ["none", "conditional", "back_calculation"])
def test_the_limit_is_reached_at_the_analytic_instant(anti_windup):
    run = drive(PI(K_p=1.0, T_i=10.0, anti_windup=anti_windup), 30.0, every=0.1, SP=0.5, PV=0.0)
    # 0.5 (1 + t / 10) = 1 at t = 10
    assert [(e.before, e.after) for e in run.events] == [("free", "at high limit")]
    assert run.events[0].t == pytest.approx(10.0, abs=1e-9)
    assert np.max(run.log["OP"]) == 1.0


def test_windup_and_its_two_cures():
    # e = 0.5 for 100 s, then -0.1; K_p = 1, T_i = 10; the limit is reached at 10 s
    SP = Staircase("SP", [0.5, -0.1], dwell=100.0)
    runs = {
        kind: drive(PI(1.0, 10.0, anti_windup=kind), 600.0, every=1.0, SP=SP, PV=0.0)
        for kind in ("none", "conditional", "back_calculation")
    }
    # none: z(100) = 5, v = -0.1 + 5 - 0.01 (t - 100) = 1 at t = 490: 390 s of windup
    assert next(e.t for e in runs["none"].events if e.after == "free") == pytest.approx(490.0, abs=1e-6)
    # conditional: z stays at 0.5, so OP(100) = 0.5 - 0.1
    assert runs["conditional"].log["OP"][100] == pytest.approx(0.4, abs=1e-9)
    # back-calculation, T_t = T_i: z = 1 - 0.5 exp(-(t - 10) / 10)
    assert runs["back_calculation"].log["OP"][100] == pytest.approx(0.9 - 0.5 * math.exp(-9.0), abs=1e-6)


def test_tracking_time_is_the_time_constant_of_back_calculation():
    pi = PI(1.0, 10.0, T_t=2.0)
    run = drive(pi, 14.0, every=1.0, SP=Staircase("SP", [0.5, -0.1], at=[0.0, 14.0]), PV=0.0)
    # z' = K_p e / T_i + (1 - 0.5 - z) / T_t from z = 0.5 at 10 s: z = 0.6 - 0.1 exp(-(t - 10) / 2)
    assert run.final["controller"].x0[0] == pytest.approx(0.6 - 0.1 * math.exp(-2.0), abs=1e-6)


def test_zero_tracking_time_follows_the_integral_time():
    SP = Staircase("SP", [0.5, -0.1], dwell=30.0)
    faster = PI(1.0, 10.0).with_params(T_i=5.0)
    written = PI(1.0, 5.0, T_t=5.0)
    a, b = (drive(pi, 60.0, every=1.0, SP=SP, PV=0.0).log["OP"] for pi in (faster, written))
    np.testing.assert_allclose(a, b, atol=1e-9)


def test_bumpless_start():
    for action in ("reverse", "direct"):
        pi = PI(K_p=2.0, T_i=20.0, action=action, start_op=0.6, start_error=-0.15)
        assert drive(pi, 1.0, every=1.0, SP=0.35, PV=0.5).log["OP"][0] == pytest.approx(0.6, abs=1e-12)


def test_riding_along_the_limit_is_exact():
    # e = A sin(w t), v reaches 1 from below while e falls and K_p (e' + e / T_i) > 0; the ride ends where this
    # is zero, tan(w t) = -w T_i
    A, w, K_p, T_i = 0.3, 2 * math.pi / 20.0, 2.0, 5.0
    pi = PI(K_p, T_i, anti_windup="conditional")
    run = drive(pi, 10.0, every=0.01, SP=Sine("SP", A, 20.0), PV=0.0)
    assert run.ok
    assert [e.after for e in run.events] == ["riding high limit", "free"]
    start, end = (e.t for e in run.events)
    # v = K_p A sin(w t) + K_p A (1 - cos(w t)) / (w T_i) = 1 at the start
    assert K_p * A * math.sin(w * start) + K_p * A * (1 - math.cos(w * start)) / (w * T_i) == pytest.approx(
        1.0, abs=1e-6
    )
    assert end == pytest.approx((math.pi - math.atan(w * T_i)) / w, abs=1e-6)
    t = run.log.t
    assert np.all(run.log["OP"][(t > start) & (t < end)] == 1.0)
    # afterwards z goes on from 1 - K_p e(end)
    z = 1.0 - K_p * A * math.sin(w * end) + K_p * A / (w * T_i) * (math.cos(w * end) - np.cos(w * t))
    after = t > end
    np.testing.assert_allclose(run.log["OP"][after], (K_p * A * np.sin(w * t) + z)[after], atol=2e-6)


def test_a_ramp_that_turns_round_while_riding_holds_the_integral():
    # falling slowly along the limit, then rising again: held, and the OP leaves only when the error has
    # fallen below where it turned
    SP = Recorded("SP", [0.0, 5.0, 20.0, 30.0, 60.0], [0.4, 0.5, 0.35, 0.5, -0.1])
    run = drive(PI(2.0, 10.0, anti_windup="conditional"), 60.0, every=0.1, SP=SP, PV=0.0)
    assert run.ok
    # e = 0.5 at the start of the fall (-0.01 / s): K_p (e' + e / T_i) = 2 (-0.01 + 0.05) > 0, so v = 0.8 ... rides
    kinds = [e.after for e in run.events]
    assert kinds == ["at high limit", "riding high limit", "at high limit", "riding high limit", "free"]
    # v returns to the limit when SP has fallen back to 0.35 (-0.02 / s from 0.5 at 30 s): 37.5 s
    assert run.events[3].t == pytest.approx(37.5, abs=1e-6)
    # the second ride ends where e / T_i = 0.02, e = 0.2, 45 s
    assert run.events[4].t == pytest.approx(45.0, abs=1e-6)


CONDITIONS = [
    ("none", math.inf),
    ("conditional", math.inf),
    ("back_calculation", 3.0),
]


@pytest.mark.parametrize(("anti_windup", "T_t"), CONDITIONS)
def test_two_sines_agree_with_the_textbook_in_fine_steps(anti_windup, T_t):
    law = {"K_p": 2.0, "T_i": 5.0, "low": 0.0, "high": 1.0, "anti_windup": anti_windup}
    pi = PI(**law, T_t=T_t if math.isfinite(T_t) else 0.0)
    parts = [Sine("a", 0.35, 20.0), Sine("b", 0.2, 6.7, phase=1.0), Sum("SP", {"a": 1.0, "b": 1.0, "c": 1.0}), pi]
    parts += [Ramp("c", 0.001), Ramp("PV", 0.0)]
    run = simulate(wire(parts), 80.0, every=0.5)
    assert run.ok

    def e(t):
        return 0.35 * np.sin(2 * np.pi * t / 20.0) + 0.2 * np.sin(2 * np.pi * t / 6.7 + 1.0) + 0.001 * t

    reference = textbook(e, 80.0, **law, T_t=T_t)
    np.testing.assert_allclose(run.log["OP"], reference, atol=2e-3)  # Euler's own error is about 1e-3 here
    assert len(run.events) < 120  # 24 crests of the fast sine: a handful of events each, no chattering
    if anti_windup == "conditional":
        assert any("riding" in event.after for event in run.events)


def test_jumps_while_riding_agree_with_the_textbook():
    # riding from 0.8 s on; small and large jumps inwards and outwards meet it there
    levels, at = [0.0, -0.03, 0.05, -0.4, 0.3, 0.0], [0.0, 12.0, 14.0, 16.0, 18.0, 22.0]
    law = {"K_p": 1.5, "T_i": 4.0, "low": 0.0, "high": 1.0, "anti_windup": "conditional"}
    parts = [Ramp("fall", -0.02, before=0.7), Staircase("jumps", levels, at=at), Ramp("PV", 0.0)]
    parts += [Sum("SP", {"fall": 1.0, "jumps": 1.0}), PI(**law)]
    run = simulate(wire(parts), 60.0, every=0.5)
    assert run.ok

    def e(t):
        return 0.7 - 0.02 * t + np.array(levels)[np.searchsorted(at, t, side="right") - 1]

    np.testing.assert_allclose(run.log["OP"], textbook(e, 60.0, **law), atol=2e-3)
    assert sum(e.after == "riding high limit" for e in run.events) >= 2


@pytest.mark.parametrize(("anti_windup", "T_t"), CONDITIONS)
def test_a_saturating_closed_loop_agrees_with_the_textbook_in_fine_steps(anti_windup, T_t):
    # first-order process, gain 3, tau 10 s; the set point asks for more than the limit allows, then for less
    levels, at = [2.5, 3.2, 0.5, 2.8], [0.0, 40.0, 80.0, 120.0]
    law = {"K_p": 2.0, "T_i": 4.0, "low": 0.0, "high": 1.0, "anti_windup": anti_windup}
    pi = PI(**law, T_t=T_t if math.isfinite(T_t) else 0.0)
    process = Sensor(tau=10.0, factor=3.0, name="process", inputs="OP", outputs="PV")
    run = simulate(wire([Staircase("SP", levels, at=at), pi, process]), 160.0, every=0.5)
    assert run.ok
    z, PV, h, expected = 0.0, 0.0, 1e-3, []
    for i in range(160_001):
        e = levels[np.searchsorted(at, (i + 1e-6) * h, side="right") - 1] - PV
        v = 2.0 * e + z
        OP = min(max(v, 0.0), 1.0)
        if i % 500 == 0:
            expected.append(OP)
        if anti_windup != "conditional" or not ((v > 1.0 and e > 0) or (v < 0.0 and e < 0)):
            z += h * 2.0 * e / 4.0
        if anti_windup == "back_calculation":
            z += h * (OP - v) / T_t
        PV += h * (3.0 * OP - PV) / 10.0
    np.testing.assert_allclose(run.log["OP"], expected, atol=3e-3)  # Euler's own error
    assert len(run.events) < 40


def test_noisy_samples_do_not_chatter():
    sensor = SampledSensor(0.5, sd=0.02, seed=4)
    pi = PI(3.0, 8.0, anti_windup="conditional", inputs={"PV": "PV_m"})
    wave = Triangle("PV", 0.3, 60.0)
    run = simulate(wire([wave, sensor, Ramp("SP", 0.0), pi]), 600.0, every=0.5)
    assert run.ok
    assert np.min(run.log["OP"]) == 0.0
    assert np.max(run.log["OP"]) == 1.0
    assert len(run.events) < 3 * 1200  # at most a few changes per sample


def test_start_beyond_the_limit_unwinds_inwards_only():
    # z = 2 at the start, e = -0.1: v = 1.9 falls at 0.01 / s and reaches 1 at 90 s
    pi = PI(1.0, 10.0, anti_windup="conditional").starting_at(z=2.0)
    run = drive(pi, 100.0, every=1.0, SP=0.0, PV=0.1)
    assert [e.after for e in run.events] == ["leaving high limit", "free"]
    assert run.events[1].t == pytest.approx(90.0, abs=1e-6)


@settings(max_examples=60)
@given(
    K_p=st.floats(0.05, 20.0),
    T_i=st.floats(0.5, 200.0),
    anti_windup=st.sampled_from(["none", "conditional", "back_calculation"]),
    action=st.sampled_from(["reverse", "direct"]),
    levels=st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=6),
    amplitude=st.floats(0.0, 1.0),
    period=st.floats(1.0, 50.0),
)
def test_op_never_leaves_its_limits_and_the_block_never_changes(
    K_p, T_i, anti_windup, action, levels, amplitude, period
):
    pi = PI(K_p, T_i, low=-0.2, high=0.7, action=action, anti_windup=anti_windup)
    before = (pi.p.copy(), pi.x0.copy(), pi.d0.copy())
    run = drive(pi, 40.0, every=0.1, SP=Staircase("SP", levels, dwell=7.0), PV=Sine("PV", amplitude, period))
    assert run.ok, run.hint
    assert np.all((run.log["OP"] >= -0.2) & (run.log["OP"] <= 0.7))
    assert len(run.events) < 20 * (40.0 / period + len(levels) + 1)
    for old, new in zip(before, (pi.p, pi.x0, pi.d0), strict=True):
        np.testing.assert_array_equal(old, new)


@settings(max_examples=15)
@given(
    K_p=st.floats(0.5, 5.0),
    T_i=st.floats(1.0, 30.0),
    amplitude=st.floats(0.1, 0.6),
    period=st.floats(4.0, 40.0),
    slope=st.floats(-0.01, 0.01),
)
def test_conditional_integration_agrees_with_the_textbook_for_any_sine(K_p, T_i, amplitude, period, slope):
    law = {"K_p": K_p, "T_i": T_i, "low": 0.0, "high": 1.0, "anti_windup": "conditional"}
    inputs = {"SP": Sine("SP", amplitude, period), "PV": Ramp("PV", -slope)}
    run = drive(PI(**law, start_op=0.4), 40.0, every=0.5, **inputs)
    reference = textbook(lambda t: amplitude * np.sin(2 * np.pi * t / period) + slope * t, 40.0, **law, z=0.4, h=5e-4)
    # Euler: at most h/2 max|e'| K_p / T_i per second, and one step of either kind at each switch
    bound = 5e-4 * K_p * (amplitude * 7.0 / period + amplitude / T_i + 0.02) * 40.0 + 1e-4
    assert run.ok
    assert np.max(np.abs(run.log["OP"] - reference)) < bound


def test_python_control_sees_the_same_controller():
    t = np.linspace(0.0, 30.0, 301)
    SP = 0.05 * np.sin(t / 3.0)
    response = ct.input_output_response(PI(0.8, 6.0, **WIDE), t, [SP, 0 * t], solve_ivp_kwargs={"rtol": 1e-8})
    integral = 0.05 * 3.0 * (1 - np.cos(t / 3.0))
    np.testing.assert_allclose(response.outputs[0], 0.8 * (SP + integral / 6.0), atol=2e-4)  # SP is joined by lines


@pytest.mark.parametrize("anti_windup", ["none", "conditional", "back_calculation"])
def test_python_control_sees_limits_and_anti_windup(anti_windup):
    t = np.linspace(0.0, 40.0, 401)
    SP = Square("SP", 0.4, 26.0)
    pi = PI(1.5, 5.0, anti_windup=anti_windup)
    u = [[float(SP.output(s, [], [])[0]) for s in t], 0 * t]
    response = ct.input_output_response(pi, t, u, solve_ivp_kwargs={"max_step": 0.01})
    run = drive(pi, 40.0, every=0.1, SP=Recorded("SP", t, u[0]), PV=0.0)
    np.testing.assert_allclose(response.outputs[0], run.log["OP"], atol=5e-3)


def test_linearised_it_is_the_ideal_form():
    linear = ct.linearize(PI(0.8, 6.0), [0.5], [0.0, 0.0])
    assert float(linear.B[0, 0]) == pytest.approx(0.8 / 6.0, rel=1e-6)
    assert linear.D[0].tolist() == pytest.approx([0.8, -0.8], rel=1e-6)


def test_span_of_op_are_its_limits_if_finite():
    assert PI(1.0, 1.0, low=0.0, high=100.0).spans == {"OP": (0.0, 100.0)}
    assert PI(1.0, 1.0, low=0.0, high=math.inf).spans == {}
    assert PI(1.0, 1.0, spans={"OP": (-1.0, 1.0)}).spans == {"OP": (-1.0, 1.0)}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PI(-1.0, 5.0), ["controller: K_p = -1.0", "positive", "direct"]),
        (lambda: PI(1.0, 0.0), ["T_i = 0.0", "positive", "math.inf"]),
        (lambda: PI(1.0, 5.0, T_t=-1.0), ["T_t = -1.0", "negative"]),
        (lambda: PI(1.0, 5.0, low=1.0, high=0.0), ["low = 1.0", "below high = 0.0"]),
        (lambda: PI(1.0, 5.0, action="revers"), ["action = 'revers'", "did you mean 'reverse'"]),
        (lambda: PI(1.0, 5.0, anti_windup="clamp"), ["anti_windup = 'clamp'", "conditional"]),
        (lambda: PI(1.0, 5.0, start_op=1.2), ["start_op = 1.2", "0.0 ... 1.0", "within"]),
        (lambda: PI(1.0, 5.0).with_params(action=0.5), ["action = 0.5", "+1 (reverse)"]),
        (lambda: PI(1.0, 5.0).with_params(K_P=0.5), ["K_P", "did you mean 'K_p'"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)


@pytest.mark.parametrize("coupling", [1e-3, -1e-3, 0.01, 0.1])
def test_weakly_coupled_controllers_that_rest_on_their_limit_do_not_chatter(coupling):
    n = 12
    blocks = [Step("SP0", 0.5, at=1.0), *(Constant(f"SP{i}", 0.0) for i in range(1, n))]
    for i in range(n):
        blocks += [
            PI(0.4, 10.0, name=f"C{i}", inputs=[f"SP{i}", f"PV{i}"], outputs=f"OP{i}"),
            Sum(f"u{i}", {f"OP{i}": 1.0, f"PV{i - 1 if i else n - 1}": coupling}),
            FirstOrder(1.0, 10.0 + i, name=f"P{i}", inputs=f"u{i}", outputs=f"PV{i}"),
        ]
    run = simulate(wire(blocks), 200.0)
    assert run.ok and len(run.events) < 2 * n  # was CHATTERING at -1e-3 and 0.01
