"""First-order process: closed forms, exact dead time, python-control."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Step
from stickslip.diagram import drive, simulate, wire

TIGHT = {"rtol": 1e-9, "atol": 1e-12}


@settings(max_examples=20)
@given(
    K=st.floats(-5.0, 5.0),
    tau=st.floats(0.1, 50.0),
    theta=st.just(0.0) | st.floats(0.05, 20.0),
    start=st.floats(-1.0, 1.0),
    u=st.floats(-1.0, 1.0),
)
def test_step_response(K, tau, theta, start, u):
    process = FirstOrder(K, tau, theta, start=start, theta_start=0.25)
    run = simulate(wire([Step("MV", u), process]), 40.0, every=0.5, **TIGHT)
    t = run.log.t

    def towards(y0, end, s):
        return end + (y0 - end) * np.exp(-s / tau)

    at_theta = towards(start, 0.25 * K, theta)
    late = np.maximum(t - theta, 0.0)
    expected = np.where(t <= theta, towards(start, 0.25 * K, np.minimum(t, theta)), towards(at_theta, K * u, late))
    assert run.ok
    np.testing.assert_allclose(run.log["PV"], expected, atol=1e-7)  # analytic


def test_sine_response_after_the_transient():
    K, tau, theta, period = 3.0, 10.0, 4.0, 30.0
    source = Sine("MV", 0.2, period, mean=0.5)
    run = simulate(wire([source, FirstOrder(K, tau, theta, start=1.5)]), 400.0, every=0.5, **TIGHT)
    w = 2 * np.pi / period
    gain = K * np.exp(-1j * w * theta) / (1 + 1j * w * tau)
    expected = 1.5 + 0.2 * np.imag(gain * np.exp(1j * w * run.log.t))  # analytic
    late = run.log.t > 300.0
    np.testing.assert_allclose(run.log["PV"][late], expected[late], atol=1e-6)


def test_starts_in_steady_state():
    run = drive(FirstOrder(3.0, 10.0, 5.0, start=1.5), 100.0, MV=0.5)
    np.testing.assert_allclose(run.log["PV"], 1.5, atol=1e-12)  # analytic: MV before the start is start/K


def test_agrees_with_python_control():
    times = np.linspace(0.0, 50.0, 101)
    u = 0.3 + 0.2 * np.sin(times / 7.0)
    process = FirstOrder(3.0, 10.0)
    theirs = ct.input_output_response(process, times, u, [0.0], solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-12})
    ours = simulate(wire([Recorded("MV", times, u), process]), 50.0, times=times, **TIGHT)
    np.testing.assert_allclose(ours.log["PV"], theirs.outputs, atol=1e-6)
    delayed = process.with_params(theta=4.0)
    x0 = delayed.seen_start()
    theirs = ct.input_output_response(delayed, times, u, x0, solve_ivp_kwargs={"rtol": 1e-8, "max_step": 0.5})
    ours = simulate(wire([Recorded("MV", times, u), delayed]), 50.0, times=times, **TIGHT)
    # Pade smears the jump at the start over about theta/2: 3/10 x 0.3 x 0.16 x 1 s and less afterwards
    np.testing.assert_allclose(ours.log["PV"], theirs.outputs, atol=0.02)
    np.testing.assert_allclose(ours.log["PV"][60:], theirs.outputs[60:], atol=1e-4)


def test_linear_view():
    view = ct.linearize(FirstOrder(3.0, 10.0), [0.0], [0.0])
    np.testing.assert_allclose([*ct.poles(view).real, ct.dcgain(view)], [-0.1, 3.0], rtol=1e-6)  # analytic


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"process: tau = 0.0, but a time constant is positive; give tau in seconds"):
        FirstOrder(1.0, 0.0)
    with pytest.raises(BlockError, match=r"theta = -1.0"):
        FirstOrder(1.0, 1.0, -1.0)
    with pytest.raises(BlockError, match=r"K = inf"):
        FirstOrder(float("inf"), 1.0)
