"""Gas turbine: a lag, a rating, no brake."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks.gas_turbine import GasTurbine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.shaft import Shaft
from stickslip.blocks.sources import Constant, Ramp, Step
from stickslip.diagram import drive, simulate, wire

W = 994.838


def test_lag():
    run = drive(GasTurbine(T=0.4, start=10e3), 3.0, every=0.1, tau_SP=Step("tau_SP", 12e3, 10e3, at=1.0), w=W)
    t = run.log.t
    expected = np.where(t < 1.0, 10e3, 12e3 - 2e3 * np.exp(-(t - 1.0) / 0.4))  # analytic
    np.testing.assert_allclose(run.log["tau_d"], expected, rtol=1e-6)
    linear = ct.linearize(GasTurbine(T=0.4, start=10e3), [10e3], [10e3, W])
    assert linear.poles() == pytest.approx([-2.5])
    assert linear.dcgain().ravel() == pytest.approx([1.0, 0.0])  # within its rating the speed does not matter


def test_torque_limit():
    run = drive(
        GasTurbine(T=0.1, tau_max=15e3, start=10e3), 5.0, every=1.0, tau_SP=Ramp("a", 4e3, before=10e3), w=100.0
    )
    assert run.log["tau_d"][-1] == pytest.approx(15e3, rel=1e-6)
    [event] = run.events
    assert event.after == "at its rating" and event.t == pytest.approx(1.25, abs=1e-9)  # analytic


def test_power_limit_follows_the_speed():
    turbine = GasTurbine(T=0.05, P_max=10e6, start=9e3)
    run = drive(turbine, 20.0, every=1.0, tau_SP=20e3, w=Ramp("w", 5.0, before=900.0))
    w = 900.0 + 5.0 * run.log.t[5:]
    np.testing.assert_allclose(run.log["tau_d"][5:] * w, 10e6, rtol=1e-3)  # analytic but for the lag
    assert (run.log["tau_d"] * (900.0 + 5.0 * run.log.t)).max() < 10e6 * 1.001


def test_it_cannot_brake():
    run = drive(GasTurbine(T=0.2, start=5e3), 4.0, every=0.5, tau_SP=Step("a", -1e4, 5e3, at=1.0), w=W)
    assert run.log["tau_d"].min() >= 0.0 and run.log["tau_d"][-1] < 5e3 * np.exp(-3.0 / 0.2) * 1.01
    assert [event.after for event in run.events] == ["idle"]


def test_from_one_limit_to_the_other():
    turbine = GasTurbine(T=0.2, tau_max=10e3, start=5e3)
    run = drive(turbine, 3.0, every=0.5, tau_SP=Step("a", -1.0, 12e3, at=1.0), w=100.0)
    assert [event.after for event in run.events] == ["at its rating", "free", "idle"]


def test_speed_control_through_the_turbine():
    """Rest is rest, and after a load step the speed comes back: the turbine changes no operating point."""
    blocks = [
        Constant("SP", W, unit="rad/s"),
        PI(400.0, 4.0, low=0.0, high=25e3, start_op=15e3, name="SC", inputs=["SP", "w"], outputs="tau_SP",
           units={"SP": "rad/s", "PV": "rad/s", "OP": "N m"}),
        GasTurbine(T=0.2, start=15e3),
        Step("tau", 15.5e3, 15e3, at=10.0, unit="N m"),
        Shaft(200.0, start=W),
    ]  # fmt: skip
    run = simulate(wire(blocks), 80.0, every=0.1)
    np.testing.assert_allclose(run.log["w"][run.log.t < 10.0], W, rtol=1e-12)
    assert run.log["w"].min() < W - 0.5
    assert run.log["w"][-1] == pytest.approx(W, abs=1e-3) and run.log["tau_d"][-1] == pytest.approx(15.5e3, rel=1e-4)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"T = 0.0, but it must be positive and finite"):
        GasTurbine(T=0.0)
    with pytest.raises(BlockError, match=r"start = 30000.0, but the torque is limited to 0 ... 25000.0"):
        GasTurbine(start=30e3)
