"""Anti-surge controller: nonlinear gain, saturation, forgetting."""

import numpy as np
import pytest

from blocks.anti_surge import AntiSurge
from blocks.ports import BlockError
from blocks.sources import Step
from plant import drive


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


def test_python_control_sees_the_same_equations():
    asc = AntiSurge(0.22, 3.0, start=0.05)
    assert asc.dynamics(0.0, [0.05], [0.9, 0.56])[0] == pytest.approx(-0.05 / 3.0, rel=1e-12)  # at the lower limit
    e = 1.18 * 0.56 - 0.6
    assert asc.dynamics(0.0, [0.05], [0.6, 0.56])[0] == pytest.approx(0.22 * (1 + 10 * e) * e / 3.0, rel=1e-12)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"margin = 0.9, but the set point lies on the safe side of surge"):
        AntiSurge(margin=0.9)
    with pytest.raises(BlockError, match=r"boost = -1.0"):
        AntiSurge(boost=-1.0)
