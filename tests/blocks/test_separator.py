"""Separator: gas law, Raoult, balances."""

import math

import numpy as np
import pytest
from stickslip.blocks.ports import BlockError
from stickslip.blocks.separator import Separator
from stickslip.blocks.sources import Step
from stickslip.diagram import drive

REST = {"F_in": 8000.0, "Z_I": 0.37, "F_L": 5716.28101809346, "F_G": 2283.7189819065397, "F_flare": 0.0}


def test_outputs_are_the_equations():
    S = Separator(N_oil=3.1e5, N_metL=4.2e4, N_metG=4.9e4)
    p, V, z, F_sep = S.output(0.0, S.x0, np.zeros(5))
    volume = 0.086 / 659.0 * 3.1e5 + 0.016 / 422.0 * 4.2e4  # analytic, molar volumes
    pressure = 4.9e4 * 8.31 * 308.15 / (81.9 - volume)  # analytic, ideal gas
    assert pytest.approx(volume, rel=1e-14) == V
    assert p == pytest.approx(pressure, rel=1e-14)
    assert z == pytest.approx(4.2e4 / 3.52e5, rel=1e-14)
    assert F_sep == pytest.approx(0.026 * (261e5 * z - pressure), rel=1e-12)


def test_gas_dissolves_again_when_pressure_is_high():
    S = Separator(N_metL=2e4)
    assert S.output(0.0, S.x0, np.zeros(5))[3] < 0.0


def test_balances_hold_for_any_flows():
    S = Separator()
    rng = np.random.default_rng(1)
    for _ in range(20):
        u = rng.uniform([0, 0, 0, 0, 0], [9e3, 1, 9e3, 4e3, 50])
        dx = S.dynamics(0.0, S.x0, u)
        z = S.x0[1] / (S.x0[0] + S.x0[1])
        assert dx[0] == pytest.approx((1 - u[1]) * u[0] - (1 - z) * u[2], rel=1e-12)  # analytic: hexane
        assert dx[1] + dx[2] == pytest.approx(u[1] * u[0] - z * u[2] - u[3] - u[4], rel=1e-9)  # methane; F_sep cancels


def test_contents_follow_the_flows_in_the_engine():
    run = drive(Separator(), 100.0, every=1.0, rtol=1e-8, **(REST | {"F_in": Step("F_in", 8100.0, 8000.0, at=40.0)}))
    S = run.final["separator"]
    z = run.log["z"]
    drawn = np.trapezoid((1.0 - z) * REST["F_L"], run.log.t)
    gained = 0.63 * (8000.0 * 40.0 + 8100.0 * 60.0) - drawn  # analytic: hexane in minus hexane out
    assert S.x0[0] - Separator().x0[0] == pytest.approx(gained, rel=2e-4)  # trapezoid of the logged outflow
    assert z[-1] > z[0]


def test_boil_off_is_fast():
    """The dissolved methane settles with 1/(C_4 p_metV/N) and the gas that comes with it: below a second."""
    S = Separator()
    run = drive(S.starting_at(N_metG=0.99 * S.x0[2]), 3.0, every=0.001, **REST)
    flow = run.log["F_sep"] - REST["F_G"]
    assert flow[0] == pytest.approx(0.026 * 0.01 * 30e5, rel=1e-3)  # analytic: C_4 times the fall of pressure
    decay = run.log.t[np.argmax(flow < flow[0] / np.e)]
    N = S.x0[0] + S.x0[1]
    gas = 8.31 * 308.15 / (81.9 - 40.95)
    z = S.x0[1] / N
    assert decay == pytest.approx(1.0 / (0.026 * (261e5 * (1.0 - z) / N + gas)), rel=0.03)  # analytic, linearised


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"V_sep = 30.0, but the contents, 40.95 m3 of liquid, must fit in"):
        Separator(30.0)
    with pytest.raises(BlockError, match=r"N_metG = 0.0, but a separator holds both phases"):
        Separator(N_metG=0.0)
    with pytest.raises(BlockError, match=r"C_4 = -1.0"):
        Separator(C_4=-1.0)


@pytest.mark.parametrize(
    ("contents", "says"),
    [
        ({"N_oil": 7e5}, "separator is full: 92.89 of 81.9 m3 are liquid"),
        ({"N_oil": 0.0, "N_metL": 0.0}, "separator has run dry: 0 of 81.9 m3 are liquid"),
        ({"N_metL": -1.0}, "separator has no dissolved methane left: N_metL = -1 mol"),
        ({"N_metG": -1.0}, "separator has no gas left: N_metG = -1 mol"),
    ],
)
def test_beyond_its_contents_it_gives_no_values_and_says_why(contents, says):
    S = Separator().starting_at(**contents)
    assert np.isnan(S.output(0.0, S.x0, np.zeros(5))).all() and np.isnan(S.dynamics(0.0, S.x0, np.zeros(5))).all()
    assert S.trouble() == says and Separator().trouble() == ""


@pytest.mark.parametrize("method", ["auto", "stiff", "explicit"])
def test_a_full_vessel_ends_the_run_when_it_is_full(method):
    """Fed without an outlet for oil; the flare keeps the pressure, so all the room goes to liquid."""
    flows = REST | {"F_L": 0.0, "Z_I": 30.0 / 261.0, "F_G": 0.0}
    run = drive(Separator(N_metG=1.0), 100.0, every=0.05, method=method, **flows)
    assert not run.ok and run.final["separator"].trouble().startswith("separator is full: 81.9 of 81.9 m3")
    reached = np.isfinite(run.log["p"])
    V = run.log["V"][reached]
    # analytic: oil and dissolved methane both only come in
    inflow = 8000.0 * ((1.0 - 30.0 / 261.0) * 0.086 / 659.0 + 30.0 / 261.0 * 0.016 / 422.0)
    assert run.log.t[reached][-1] == pytest.approx((81.9 - V[0]) / inflow, rel=0.02)
    assert V.max() < 81.9 and run.log["p"][reached].min() > 0.0


def test_contents_and_molar_masses_that_cannot_be():
    for moles in (0.0, -1.0, math.nan):
        with pytest.raises(BlockError, match=r"N_oil = .*, but a separator holds both phases"):
            Separator(N_oil=moles)
    with pytest.raises(BlockError, match=r"N_metG = inf, but it must start at a finite number"):
        Separator(N_metG=math.inf)
    with pytest.raises(BlockError, match=r"W_oil = 86.0, but it is in kg/mol; divide g/mol by 1000"):
        Separator(V_sep=1e5, W_oil=86.0)
