"""PID: its transfer functions by python-control, limits, anti-windup, bumpless start, and refusals."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, PID, FirstOrder, SecondOrder, Staircase, Step
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}


def transfer(K_p, T_i, T_d, N, b, c):
    """Return the textbook's transfer functions from SP and from PV to OP [analytic]."""
    s = ct.tf("s")
    derivative = s * T_d / (1 + s * T_d / N)
    return K_p * (b + 1 / (T_i * s) + c * derivative), -K_p * (1 + 1 / (T_i * s) + derivative)


@pytest.mark.parametrize(("b", "c"), [(1.0, 0.0), (0.4, 0.0), (1.0, 1.0)])
@pytest.mark.parametrize("channel", [0, 1])
def test_step_responses_are_those_of_the_transfer_functions(b, c, channel):
    K_p, T_i, T_d, N = 0.7, 8.0, 3.0, 12.0
    inputs = {"SP": 0.0, "PV": 0.0} | {("SP", "PV")[channel]: 1.0}
    run = drive(PID(K_p, T_i, T_d, N=N, b=b, c=c, **WIDE), 30.0, every=0.25, rtol=1e-9, method="stiff", **inputs)
    _, expected = ct.step_response(transfer(K_p, T_i, T_d, N, b, c)[channel], run.log.t)  # analytic
    np.testing.assert_allclose(run.log["OP"], expected, atol=1e-7)


@pytest.mark.parametrize("action", ["reverse", "direct"])
def test_linearised_it_has_the_textbook_frequency_response(action):
    pid = PID(0.7, 8.0, 3.0, N=12.0, b=0.6, c=0.3, action=action)
    model = ct.linearize(pid, pid.starting_at(z=0.5).x0, [0.0, 0.0])
    sign = 1.0 if action == "reverse" else -1.0
    for w in (0.01, 0.3, 5.0, 100.0):
        found = np.asarray(model(1j * w)).ravel()
        expected = [sign * complex(G(1j * w)) for G in transfer(0.7, 8.0, 3.0, 12.0, 0.6, 0.3)]  # analytic
        np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_slow_filter_of_a_tiny_derivative_leaves_the_pi():
    loop = [Step("SP", after=0.5), FirstOrder(K=2.0, tau=10.0, inputs=["OP"])]
    pi = simulate(wire([*loop, PI(0.9, 6.0)]), 60.0, every=0.5)
    pid = simulate(wire([*loop, PID(0.9, 6.0, 1e-7)]), 60.0, every=0.5)
    np.testing.assert_allclose(pid.log["PV"], pi.log["PV"], atol=2e-6)


def test_the_derivative_damps_a_second_order_process():
    loop = [Step("SP", after=0.5), SecondOrder(K=1.0, omega=0.2, zeta=0.2, inputs=["OP"])]
    overshoot = {
        name: simulate(wire([*loop, block]), 200.0, every=0.1).log["PV"].max() - 0.5
        for name, block in {"PI": PI(0.5, 10.0, **WIDE), "PID": PID(0.5, 10.0, 10.0, **WIDE)}.items()
    }
    assert overshoot["PID"] < 0.3 * overshoot["PI"]


def test_windup_ends_with_the_tracking_time():
    # e = 1 for 100 s: v rests where K_p e/T_i = (v - 1)/T_t, v = 1 + 4/10 = 1.4, z = v - K_p e = 0.4   [analytic]
    SP = Staircase("SP", [1.0, 0.0], dwell=100.0)
    pid = PID(1.0, 10.0, 1.6, T_t=4.0)
    run = drive(pid, 100.0, every=1.0, SP=SP, PV=0.0)
    assert run.final["controller"].x0[0] == pytest.approx(0.4, abs=1e-6)
    assert PID(1.0, 10.0, 1.6).p[4] == 0.0  # sqrt(10 x 1.6) = 4 s, so the same
    same = drive(PID(1.0, 10.0, 1.6), 100.0, every=1.0, SP=SP, PV=0.0)
    assert same.final["controller"].x0[0] == pytest.approx(0.4, abs=1e-6)


def test_limits_are_located():
    run = drive(PID(1.0, 10.0, 2.0), 30.0, every=0.1, SP=0.5, PV=0.0)
    assert [(e.before, e.after) for e in run.events] == [("free", "at high limit")]
    assert run.events[0].t == pytest.approx(10.0, abs=1e-9)  # 0.5 (1 + t/10) = 1   [analytic]
    assert run.log["OP"].max() == 1.0


def test_bumpless_start():
    pid = PID(0.8, 20.0, 4.0, b=0.5, c=0.2, start_op=0.37, start_SP=0.6, start_PV=0.6)
    run = drive(pid, 10.0, every=1.0, SP=0.6, PV=0.6)
    np.testing.assert_allclose(run.log["OP"], 0.37, atol=1e-12)


def test_python_control_sees_the_limit():
    pid = PID(1.0, 10.0, 2.0)
    t = np.linspace(0.0, 30.0, 301)
    seen = ct.input_output_response(
        pid, t, [np.full_like(t, 0.5), np.zeros_like(t)], solve_ivp_kwargs={"max_step": 0.01}
    )
    run = drive(pid, 30.0, every=0.1, SP=0.5, PV=0.0)
    np.testing.assert_allclose(np.asarray(seen.outputs).ravel(), run.log["OP"], atol=1e-5)  # it steps over the limit


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: PID(0.0, 5.0, 1.0), ["K_p = 0.0", "positive"]),
        (lambda: PID(1.0, 5.0, 0.0), ["T_d = 0.0", "take PI"]),
        (lambda: PID(1.0, 5.0, 1.0, N=0.0), ["N = 0.0", "8 to 20"]),
        (lambda: PID(1.0, 5.0, 1.0, b=-0.1), ["b = -0.1", "give 0 to 1"]),
        (lambda: PID(1.0, 5.0, 1.0, start_op=1.2), ["start_op = 1.2", "0.0 ... 1.0"]),
        (lambda: PID(1.0, 5.0, 1.0, action="up"), ["action = 'up'", "reverse"]),
        (lambda: PID(1.0, 5.0, 1.0).with_params(T_d=0.0), ["T_d = 0.0", "take PI"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)
