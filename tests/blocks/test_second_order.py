"""Second-order process: closed forms over and below critical damping, python-control."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.ports import BlockError
from stickslip.blocks.second_order import SecondOrder
from stickslip.blocks.sources import Step
from stickslip.diagram import drive, simulate, wire

TIGHT = {"rtol": 1e-9, "atol": 1e-12}


def step_response(block, duration, theta=0.0):
    run = simulate(wire([Step("MV", 1.0), block]), duration, every=duration / 200, **TIGHT)
    assert run.ok
    return np.maximum(run.log.t - theta, 0.0), run.log["PV"]


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("theta", [0.0, 3.0])
def test_underdamped(zeta, theta):
    K, omega = 2.0, 0.5
    t, y = step_response(SecondOrder(K, omega, zeta, theta), 40.0, theta)
    wd = omega * math.sqrt(1 - zeta**2)
    decay = np.exp(-zeta * omega * t)
    expected = K * (1 - decay * (np.cos(wd * t) + zeta * omega / wd * np.sin(wd * t)))  # analytic
    np.testing.assert_allclose(y, expected, atol=2e-6)


def test_two_lags():
    K, a, b, theta = 3.0, 10.0, 2.0, 1.5
    t, y = step_response(SecondOrder.from_lags(K, a, b, theta), 60.0, theta)
    expected = K * (1 - (a * np.exp(-t / a) - b * np.exp(-t / b)) / (a - b))  # analytic
    np.testing.assert_allclose(y, expected, atol=1e-6)


def test_linear_view_is_the_transfer_function():
    view = ct.linearize(SecondOrder.from_lags(3.0, 10.0, 2.0), [0.0, 0.0], [0.0])
    np.testing.assert_allclose(np.sort(ct.poles(view).real), [-0.5, -0.1], rtol=1e-5)  # analytic
    assert ct.dcgain(view) == pytest.approx(3.0, rel=1e-5)
    resonant = ct.linearize(SecondOrder(2.0, 0.5, 0.1), [0.0, 0.0], [0.0])
    np.testing.assert_allclose(resonant.damp()[0], 0.5, rtol=1e-5)  # analytic: natural frequency
    np.testing.assert_allclose(resonant.damp()[1], 0.1, rtol=1e-4)


def test_starts_in_steady_state():
    run = drive(SecondOrder(3.0, 0.5, 0.7, 5.0, start=1.5), 100.0, MV=0.5)
    np.testing.assert_allclose(run.log["PV"], 1.5, atol=1e-12)  # analytic


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"omega = 0.0, but a natural frequency is positive"):
        SecondOrder(1.0, 0.0, 1.0)
    with pytest.raises(BlockError, match=r"zeta = -0.1"):
        SecondOrder(1.0, 1.0, -0.1)
    with pytest.raises(BlockError, match=r"tau2 = 0.0.*use FirstOrder"):
        SecondOrder.from_lags(1.0, 1.0, 0.0)
