"""The optional gas turbine: nothing changes at rest, the torque comes late and within its rating."""

from dataclasses import replace

import control as ct
import numpy as np
import pytest
from stickslip.blocks.sources import Step
from stickslip.diagram import WiringError, simulate
from stickslip.plant import SET_B, InfeasibleFeed, kicked, production_plant
from stickslip.plant.build import turbine_and_shaft

READINGS = ("p_1", "V_1", "p_2", "p_in2", "p_out2", "m_2", "m_3", "w", "tau_d")


def test_by_default_the_torque_is_what_sc001_asks():
    plant = production_plant("B")
    assert not any(block.name == "turbine" for block in plant.blocks) and "tau_SP" not in plant.signals
    assert plant["SC001"].params["high"] == np.inf


@pytest.mark.parametrize("name", ["A", "B"])
def test_the_operating_point_is_the_same(name):
    direct, lag = (production_plant(name, turbine=kind) for kind in ("direct", "lag"))
    runs = [simulate(plant, 500.0, every=10.0, method="stiff") for plant in (direct, lag)]
    for signal in READINGS:
        np.testing.assert_allclose(runs[1].log[signal], runs[0].log[signal][0], rtol=1e-9)  # analytic: at rest
    np.testing.assert_allclose(runs[1].log["tau_SP"], runs[1].log["tau_d"], rtol=1e-12)


def test_the_lag_makes_the_speed_loop_ring():
    """Two integrations and a gain: J T s^2 + J s + K_p, so 1/sqrt(J T/K_p) = 100 rad/s and hardly damped."""
    plant = production_plant("B", sticky=(), turbine="lag")
    poles = np.linalg.eigvals(ct.linearize(plant, plant.x0, []).A)
    ringing = poles[poles.imag > 5.0]
    assert ringing.size == 1
    assert ringing[0].imag == pytest.approx(np.sqrt(40000.0 / (20.0 * 0.2)), rel=0.01)  # analytic
    # Analytic lower bound -1/(2 T); loads that grow with speed damp it a little more.
    assert -6.0 < ringing[0].real < -2.5
    assert np.max(poles.real[np.abs(poles) > 1e-9]) < 0.0


def test_shaft_alone_behind_the_turbine():
    load = {"OP_VPCS2": 0.9, "tau_3": 1350.35, "tau_2": Step("tau_2", 15000.0, 14284.7, at=5.0)}
    run = simulate(turbine_and_shaft("B", turbine="lag"), 30.0, every=0.01, inputs=load, method="stiff")
    t, asked, given = run.log.t, run.log["tau_SP"], run.log["tau_d"]
    lag = np.gradient(given, t) * 0.2 + given  # analytic: T dtau/dt + tau is what was asked
    late = (t > 6.0) & (t < 8.0)
    assert np.abs(lag - asked)[late].max() < 0.1 * np.ptp(asked[late]) + 1.0
    assert given[-1] == pytest.approx(16350.35, rel=1e-2) and run.log["w"].min() < 994.8


def test_the_kicked_plant_runs_with_it():
    run = simulate(kicked(production_plant("B", turbine="lag")), 300.0, every=0.5, method="stiff")
    assert run.ok and np.ptp(run.log["p_1"][run.log.t > 100.0]) > 0.2e5
    assert run.log["tau_d"].min() > 0.0


def test_a_turbine_at_its_rating_lets_the_speed_sag_and_does_not_wind_up():
    small = SET_B.changed(turbine=replace(SET_B.turbine, P_max=15.9e6))
    load = {"OP_VPCS2": 0.9, "tau_3": 1350.35, "tau_2": Step("tau_2", 15000.0, 14284.7, at=5.0)}
    sag = simulate(turbine_and_shaft(small, turbine="lag"), 10.0, every=0.1, inputs=load, method="stiff")
    assert sag.log["w"][-1] < 985.0 and sag.log["tau_d"].max() <= 15.9e6 / sag.log["w"].min()
    back = load | {"tau_2": Step("tau_2", 14284.7, 15000.0, at=0.5)}
    run = simulate(turbine_and_shaft(small, turbine="lag"), 40.0, every=0.1, inputs=back, method="stiff")
    assert run.log["w"][-1] == pytest.approx(994.838, abs=0.05)
    assert run.log["w"].max() < 994.838 + 2.0


def test_misuse_is_explained():
    weak = SET_B.changed(turbine=replace(SET_B.turbine, P_max=10e6))
    with pytest.raises(InfeasibleFeed, match=r"take 15635 N m at 994.84 rad/s \(15.55 MW\).*at most 10052 N m"):
        production_plant(weak, turbine="lag")
    production_plant(weak)  # without the lag there is no rating
    with pytest.raises(WiringError, match=r"no turbine is called 'lagg'; did you mean 'lag'"):
        production_plant(turbine="lagg")
