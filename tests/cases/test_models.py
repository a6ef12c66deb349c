"""The models of loops that a diagnosis starts from: their equations, nuisances and tolerances."""

import os
from pathlib import Path

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.blocks.role import Role
from stickslip.cases import find
from stickslip.cases.models import CASES_BY_NAME, cascaded_tanks, ideal_flow, site_flow
from stickslip.diagram import simulate, wire

DATA = Path(os.environ.get("STICKSLIP_DATA", "../shared/data")) / "cascaded_tanks" / "estimation.csv"
SP = Staircase("SP", [1.5, 1.8, 1.2], at=[0.0, 10.0, 200.0])


def test_the_ideal_loop_without_noise_is_a_lag_of_its_set_point():
    loop = wire([SP, *ideal_flow(rest=1.5).with_params({"noise.sd": 0.0}).blocks])
    log = simulate(loop, 400.0, every=1.0, rtol=1e-10, atol=1e-12).log
    # analytic: T_i = tau, so the open loop is 0.12/s and PV follows SP with a time constant of 1/0.12 s
    want = np.full(401, 1.5)
    for at, step in ((10.0, 0.3), (200.0, -0.6)):
        want += step * np.where(log.t > at, 1.0 - np.exp(-0.12 * (log.t - at)), 0.0)
    np.testing.assert_allclose(log["PV"], want, atol=1e-8)
    np.testing.assert_allclose(log["OP"][[9, 199]], [0.5, 0.6], atol=1e-6)


def test_the_controller_of_the_site_scans_and_takes_in_the_present_error():
    log = simulate(wire([SP, *site_flow(rest=1.5).blocks]), 400.0, every=1.0).log
    e = log["SP"] - log["PV"]
    np.testing.assert_allclose(log["OP"], 0.5 + 0.4 * e + np.cumsum(0.04 * e), atol=1e-12)  # analytic


def test_nuisances_are_as_large_as_they_are_said_to_be():
    site = simulate(wire([SP, *site_flow(rest=1.5).blocks]), 40000.0, every=1.0).log
    assert np.std(site["load"]) == pytest.approx(0.01, rel=0.12)
    a = np.corrcoef(site["load"][1:], site["load"][:-1])[0, 1]
    assert -1.0 / np.log(a) == pytest.approx(60.0, rel=0.25)
    assert np.std(site["PV"] - site["y"]) == pytest.approx(0.004, rel=0.02)
    ideal = simulate(wire([SP, *ideal_flow(rest=1.5).blocks]), 4000.0, every=0.5).log
    noise = ideal["PV"] - ideal["y"]
    assert np.std(noise) == pytest.approx(0.004, rel=0.05)
    np.testing.assert_allclose(noise[:-1].reshape(-1, 2)[:, 1], noise[:-1].reshape(-1, 2)[:, 0], atol=1e-12)  # held


@pytest.mark.parametrize("model", [ideal_flow, site_flow])
def test_blocks_have_the_names_and_roles_of_the_contract(model):
    roles = {b.name: b.role for b in model().blocks}
    for role in (Role.CONTROLLER, Role.VALVE, Role.PROCESS, Role.SENSOR, Role.HISTORIAN):
        assert roles[str(role)] is role
    assert roles["feed"] is Role.DISTURBANCE
    assert {"PV", "OP", "MV"} <= set(model().signals) and model().open_inputs == ("SP",)


def test_other_loops_are_what_they_are_said_to_be():
    """Analytic: without noise and load each settles at its set point, with the opening that its gain asks for."""
    for name, opening in (("second_order_flow", 0.5), ("level_loop", 0.5), ("level_cascade", 0.5)):
        built = find(name).build()
        built = built.with_params({f"{b.name}.sd": 0.0 for b in built.blocks if "sd" in b.params})
        log = simulate(built, find(name).duration, every=5.0, rtol=1e-8).log
        assert log["OP"][-1] == pytest.approx(opening, abs=2e-3)
        for sp, pv in (("SP", "PV"), ("SP_L", "L")):
            if sp in log:
                assert log[pv][-1] == pytest.approx(log[sp][-1], abs=2e-3)


def test_cases_of_these_names_run():
    for name in CASES_BY_NAME:
        run = find(name).run()
        assert run.ok and run.diagram.open_inputs == ()
        assert all(np.isfinite(run.log[s]).all() for s in run.log.names)


def test_the_tanks_miss_the_record_by_what_is_said():
    if not DATA.is_file():
        pytest.skip(f"the record of the rig is not at {DATA}; set STICKSLIP_DATA")
    import polars as pl

    table = pl.read_csv(DATA)
    record = {name: table[name].to_numpy() for name in ("time", "u", "y")}
    log = simulate(cascaded_tanks(), float(record["time"][-1]), every=4.0, inputs=record).log
    assert np.sqrt(np.mean((log["y"] - record["y"]) ** 2)) == pytest.approx(0.60, abs=0.01)  # snapshot: the fit
