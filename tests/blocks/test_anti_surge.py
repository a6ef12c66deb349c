"""Anti-surge controller: nonlinear gain, saturation, forgetting."""

import numpy as np
import pytest
from stickslip.blocks.anti_surge import AntiSurge
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Ramp, Step
from stickslip.diagram import drive


def test_gain_grows_towards_surge():
    asc = AntiSurge(0.22, 3.0)
    for q in (0.66, 0.6, 0.56, 0.4):
        e = 1.18 * 0.56 - q
        assert asc.output(0.0, asc.x0, [q, 0.56])[0] == pytest.approx(0.22 * (1 + 10 * e) * e, rel=1e-12)  # analytic


def test_integrates_with_the_same_gain():
    run = drive(AntiSurge(0.22, 3.0), 5.0, every=0.5, q=0.6, q_s=0.56)
    e = 1.18 * 0.56 - 0.6
    np.testing.assert_allclose(run.log["OP"], 0.22 * (1 + 10 * e) * e * (1 + run.log.t / 3.0), rtol=1e-9)  # analytic


def test_saturates_and_lets_go_at_once():
    """Open to the stop for long, the valve starts to shut as soon as the shortage turns into a surplus."""
    run = drive(AntiSurge(0.5, 3.0), 40.0, every=0.1, q=Step("q", 0.8, 0.3, at=20.0), q_s=0.56)
    t, OP = run.log.t, run.log["OP"]
    assert OP[t < 20.0].max() == 1.0 and OP[(t > 10.0) & (t < 20.0)].min() == 1.0
    # analytic: held at 1, z settles at 1; then v = 1 + K_p E falls with K_p E/T_i
    E = 1.18 * 0.56 - 0.8
    after = (t >= 20.0) & (t < 25.0)
    np.testing.assert_allclose(OP[after], 1.0 + 0.5 * E * (1 + (t[after] - 20.0) / 3.0), atol=2e-3)
    assert {(e.before, e.after) for e in run.events} >= {("free", "at high limit"), ("at high limit", "free")}


def test_shut_valve_forgets():
    asc = AntiSurge(0.22, 3.0, start=0.05)
    run = drive(asc, 60.0, every=1.0, q=0.9, q_s=0.56)
    assert np.all(run.log["OP"][1:] == 0.0)
    assert abs(run.final["anti_surge"].x0[0]) < 1e-8  # analytic: exp(-20) of 0.05


def test_gradient_action_grows_with_the_rate_of_fall_inside_the_margin_only():
    """A ramp: after the smoothing has settled, (f - q)/T_f is the slope, and the gain has its share of it."""
    asc = AntiSurge(0.22, 1e9, gradient=300.0, limit=0.01, T_f=0.2, start_flow=0.9)
    q = Ramp("q", -0.05, start=0.0, end=8.0, before=0.9)
    run = drive(asc, 12.0, every=0.01, rtol=1e-9, q=q, q_s=0.5)
    t, OP = run.log.t, run.log["OP"]
    e = 1.18 * 0.5 - run.log["q"]
    assert np.all(OP[e <= 0.0] == 0.0)  # far from surge it sleeps, however fast the flow falls
    falling = (e > 0.0) & (t < 8.0)
    E = (1.0 + 10.0 * e + 300.0 * (0.05 - 0.01)) * e  # analytic
    np.testing.assert_allclose(OP[falling], 0.22 * E[falling], rtol=1e-5, atol=1e-8)
    still = t > 11.0  # 15 times T_f later the gain is the plain one again
    np.testing.assert_allclose(OP[still], 0.22 * (1.0 + 10.0 * e[still]) * e[still], rtol=1e-5)


def test_gradient_action_does_not_close_a_valve_when_the_flow_rises():
    plain, steep = AntiSurge(0.5, 3.0), AntiSurge(0.5, 3.0, gradient=300.0, start_flow=0.5)
    q = Ramp("q", 0.05, start=0.0, end=5.0, before=0.5)
    runs = [drive(block, 10.0, every=0.1, rtol=1e-9, q=q, q_s=0.56) for block in (plain, steep)]
    np.testing.assert_allclose(runs[1].log["OP"], runs[0].log["OP"], atol=1e-8)


def test_without_gradient_action_nothing_is_smoothed():
    assert AntiSurge().state_names == ("z",) and "gradient" not in AntiSurge().param_names
    assert AntiSurge(gradient=1.0).state_names == ("z", "f")
    with pytest.raises(BlockError, match=r"no parameter 'gradient'"):
        AntiSurge().with_params(gradient=1.0)


def test_python_control_sees_the_same_equations():
    asc = AntiSurge(0.22, 3.0, start=0.05)
    assert asc.dynamics(0.0, [0.05], [0.9, 0.56])[0] == pytest.approx(-0.05 / 3.0, rel=1e-12)  # at the lower limit
    e = 1.18 * 0.56 - 0.6
    assert asc.dynamics(0.0, [0.05], [0.6, 0.56])[0] == pytest.approx(0.22 * (1 + 10 * e) * e / 3.0, rel=1e-12)
    e, fall = 1.18 * 0.56 - 0.6, (0.7 - 0.6) / 2.0 - 0.005
    steep = AntiSurge(0.22, 3.0, gradient=100.0, start=0.05, start_flow=0.7)
    E = (1 + 10 * e + 100 * fall) * e
    np.testing.assert_allclose(steep.dynamics(0.0, steep.x0, [0.6, 0.56]), [0.22 * E / 3.0, -0.05], rtol=1e-12)
    assert steep.output(0.0, steep.x0, [0.6, 0.56])[0] == pytest.approx(0.05 + 0.22 * E, rel=1e-12)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"margin = 0.9, but the set point lies on the safe side of surge"):
        AntiSurge(margin=0.9)
    with pytest.raises(BlockError, match=r"boost = -1.0"):
        AntiSurge(boost=-1.0)
    with pytest.raises(BlockError, match=r"gradient = -1.0, but the gain must not fall with a falling flow"):
        AntiSurge(gradient=-1.0)
    with pytest.raises(BlockError, match=r"limit = -0.1"):
        AntiSurge(gradient=1.0, limit=-0.1)
    with pytest.raises(BlockError, match=r"T_f = 0.0, but a time of smoothing is positive"):
        AntiSurge(gradient=1.0, T_f=0.0)
