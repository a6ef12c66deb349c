"""Integrating process: closed forms, balance, python-control."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Step
from stickslip.diagram import drive, simulate, wire


@pytest.mark.parametrize("theta", [0.0, 2.5])
def test_step_gives_a_ramp(theta):
    process = Integrator(3.0, 10.0, theta, u_0=0.4, start=0.2)
    run = drive(process, 20.0, every=0.5, MV=Step("MV", 0.6, 0.4, at=5.0))
    expected = 0.2 + 0.3 * 0.2 * np.maximum(run.log.t - 5.0 - theta, 0.0)  # analytic
    np.testing.assert_allclose(run.log["PV"], expected, atol=5e-6)  # the engine errs by about rtol at a late jump


def test_sine():
    source = Sine("MV", 0.1, 30.0, mean=0.5)
    run = simulate(wire([source, Integrator(-2.0, 8.0, u_0=0.5)]), 90.0, every=0.5, rtol=1e-9, atol=1e-12)
    w = 2 * np.pi / 30.0
    np.testing.assert_allclose(run.log["PV"], -0.25 * 0.1 / w * (1 - np.cos(w * run.log.t)), atol=1e-7)  # analytic


def test_balance_holds_the_level():
    run = drive(Integrator(3.0, 10.0, 4.0, u_0=0.7, start=0.5), 1000.0, MV=0.7)
    np.testing.assert_allclose(run.log["PV"], 0.5, atol=1e-10)  # analytic


def test_linear_view():
    view = ct.linearize(Integrator(3.0, 10.0, u_0=0.4), [0.0], [0.4])
    assert view.A[0, 0] == 0.0 and view.B[0, 0] == pytest.approx(0.3, rel=1e-6)  # analytic


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"T = 0.0, but an integration time is positive; give T in seconds"):
        Integrator(1.0, 0.0)
    with pytest.raises(BlockError, match=r"u_0 = nan"):
        Integrator(1.0, u_0=float("nan"))
