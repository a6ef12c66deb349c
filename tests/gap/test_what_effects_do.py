"""What each effect of a loop does, by a closed form or by a loop wired by hand."""

import math

import numpy as np
import pytest
from stickslip.blocks import Constant, FirstOrder, Recorded, SampledPI, Staircase, Sum
from stickslip.cases.models import cascaded_tanks, ideal_flow, site_flow
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import effect
from stickslip.logs import Log
from stickslip.logs.dirt import swinging_door_kept

from tests.gap.effect_loops import EXACT, LOGGED, SIZES, T, put, quiet, run


def valve_alone(name, op=((0.0, 100.0), (0.2, 0.7)), first=None, **values):
    """Return the log of a valve and a process that shows its flow, under a straight OP."""
    bench = wire([Recorded("OP", *op), ideal_flow()["valve"], FirstOrder(1.0, 1e-4, inputs="MV", outputs="F")])
    one = effect(name)
    return simulate(one.started(one.insert(bench, "valve", **values), "valve", first or {}), 100.0, every=1.0).log


def test_a_valve_out_of_its_stops_rate_and_trim():
    t = np.arange(101.0)
    OP = 0.2 + 0.005 * t
    stopped = valve_alone("valve_saturation", low=30.0, high=60.0)["MV"]
    np.testing.assert_allclose(stopped, np.clip(OP, 0.3, 0.6), atol=1e-12)  # analytic
    slow = valve_alone("valve_rate_limit", rate=0.2)["MV"]
    np.testing.assert_allclose(slow, 0.2 + 0.002 * t, atol=1e-8)
    late = valve_alone("positioner_lag", first={"MV": 0.2}, tau=5.0)["MV"]
    np.testing.assert_allclose(late, OP - 0.005 * 5.0 * (1.0 - np.exp(-t / 5.0)), atol=1e-6)
    log = valve_alone("valve_characteristic", rangeability=20.0)
    np.testing.assert_allclose(log["MV"], OP, atol=1e-12)  # the stem is where it was
    np.testing.assert_allclose(log["F"][1:], (20.0 ** OP[1:] - 1.0) / 19.0, atol=3e-5)
    assert np.abs(valve_alone("valve_gain", factor=1.5)["F"][1:] - 1.5 * OP[1:]).max() < 1e-5
    assert np.abs(valve_alone("valve_leak", flow=2.0)["F"][1:] - OP[1:] - 0.02).max() < 1e-5


def test_play_follows_half_its_width_behind():
    there_and_back = ((0.0, 50.0, 100.0), (0.3, 0.7, 0.3))
    log = valve_alone("deadband", op=there_and_back, first={"MV": 0.3}, width=4.0)
    t = log.t
    want = np.where(t < 2.5, 0.3, np.where(t <= 50.0, log["OP"] - 0.02, np.where(t < 55.0, 0.68, log["OP"] + 0.02)))
    np.testing.assert_allclose(log["MV"], want, atol=1e-9)  # analytic


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("process_gain", {"process.K": 3.6}),
        ("process_time_constant", {"process.tau": 13.0}),
        ("dead_time", {"process.theta": 3.0}),
        ("controller_gain", {"controller.K_p": 0.6}),
        ("controller_integral_time", {"controller.T_i": 15.0}),
        ("controller_limits", {"controller.high": 0.58}),
        ("step_disturbance", {}),
    ],
)
def test_it_is_the_loop_with_that_number(name, change):
    place, _, plain = SIZES[name]
    loop = quiet()
    if name == "step_disturbance":
        by_hand = loop.replace("feed", Staircase("load", [0.0, 0.05], dwell=50.0))
    else:
        by_hand = loop.with_params(change)
    one, other = run(put(name, place, **plain)), run(by_hand)
    for signal in LOGGED:
        np.testing.assert_allclose(one[signal], other[signal], atol=1e-11)


def test_waves_at_the_feed_are_what_they_are_called():
    t = np.arange(401.0)
    sine = run(put("sine_disturbance", "feed", amplitude=0.05, period=60.0, phase=0.25))["load"]
    np.testing.assert_allclose(sine, 0.05 * np.sin(2.0 * np.pi * (t / 60.0 + 0.25)), atol=1e-12)
    share = (t / 100.0 + 0.2 + 0.4) % 1.0  # of the period since it was lowest
    slug = run(put("slug", "feed", amplitude=0.05, period=100.0, phase=0.2))["load"]
    want = np.where(share <= 0.8, -0.05 + 0.1 * share / 0.8, 0.05 - 0.1 * (share - 0.8) / 0.2)
    np.testing.assert_allclose(slug, want, atol=1e-9)


@pytest.mark.parametrize("name", ["sine_disturbance", "slug"])
def test_the_shape_that_is_stated_is_the_wave(name):
    one = effect(name)
    phase = np.array([0.0, 0.1, 0.35, 0.5, 0.65, 0.9])
    log = run(put(name, "feed", amplitude=0.05, period=100.0))
    np.testing.assert_allclose(log["load"][(100 * phase).astype(int)], 0.05 * one.plan(phase), atol=1e-9)


@pytest.mark.parametrize(
    ("name", "values", "want"),
    [
        ("sensor_bias", {"offset": -0.1}, lambda t, y: y - 0.1),
        ("sensor_drift", {"rate": 0.5}, lambda t, y: y + 0.5 * t / 3600.0),
        ("sensor_span", {"factor": 1.1}, lambda t, y: 1.1 * y),
        ("sensor_saturation", {"low": 1.4, "high": 1.6}, lambda t, y: np.clip(y, 1.4, 1.6)),
    ],
)
def test_the_sensor_shows(name, values, want):
    log = run(put(name, "sensor", **values), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(log["PV"], want(log.t, log["y"]), atol=1e-9)  # analytic
    assert np.abs(log["PV"] - log["y"]).max() > 1e-3


def test_a_quantised_loop_sees_multiples_of_the_step_only():
    log = run(put("quantisation", "sensor", step=0.05), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(log["PV"] / 0.05, np.round(log["PV"] / 0.05), atol=1e-9)
    assert np.abs(log["PV"] - log["y"]).max() <= 0.0255 + 1e-9  # half a step and 1 % of one
    site = quiet(site_flow)
    assert effect("quantisation").insert(site, "sensor", step=0.05)["sensor"].params["step"] == 0.05


def test_noise_is_added_behind_what_a_sensor_does_to_its_signal():
    noisy = quiet().with_params({"noise.sd": 0.004})
    drawn = run(noisy)["noise"]
    late = run(put("sensor_lag", "sensor", noisy, tau=5.0))
    np.testing.assert_allclose(late["PV"] - late["y:sensor:sensor_lag"], drawn, atol=1e-12)
    loud = run(put("sensor_noise", "sensor", noisy, factor=3.0))
    np.testing.assert_allclose(loud["PV"] - loud["y"], 3.0 * drawn, atol=1e-12)
    cut = run(put("sensor_saturation", "sensor", noisy, high=1.5))
    assert cut["PV"].max() == 1.5


def test_a_filter_in_the_error_is_a_loop_wired_by_hand():
    filtered = put("controller_filter", "controller", tau=4.0)
    filtered = effect("controller_filter").started(filtered, "controller", {"SP": 1.5, "PV": 1.5})
    loop = quiet()
    controller = loop["controller"].relabelled("controller", ["zero", "-e_f"], ["OP"])
    rest = [b for b in loop.blocks if b.name != "controller"]
    lag = FirstOrder(1.0, 4.0, name="lag", inputs="-e", outputs="-e_f")
    by_hand = wire([*rest, Constant("zero", 0.0), Sum("-e", {"PV": 1.0, "SP": -1.0}), lag, controller])
    for signal in LOGGED:
        np.testing.assert_allclose(run(filtered)[signal], run(by_hand)[signal], atol=1e-10)


def test_a_scanning_controller_holds_OP():
    log = simulate(put("scan_time", "controller", period=4.0), T, every=0.5, **EXACT).log
    k = np.flatnonzero(log.t % 4.0 == 0.0)
    assert (np.diff(log["OP"][:-1].reshape(-1, 8)) == 0.0).all()
    e = log["SP"][k] - log["PV"][k]
    z = 0.5 + np.cumsum(4.0 * 0.4 * e / 10.0)  # the integral takes in the present error first
    np.testing.assert_allclose(log["OP"][k], np.clip(0.4 * e + z, 0.0, 1.0), atol=1e-9)
    late = simulate(put("scan_time", "controller", period=4.0, present=0.0), T, every=4.0, **EXACT).log
    e = late["SP"] - late["PV"]
    z = 0.5 + np.concatenate([[0.0], np.cumsum(4.0 * 0.4 * e / 10.0)[:-1]])
    np.testing.assert_allclose(late["OP"], np.clip(0.4 * e + z, 0.0, 1.0), atol=1e-9)


def test_a_site_filters_and_scans_at_its_own_scans():
    site = quiet(site_flow)
    assert effect("scan_time").nominal(site, "controller")["period"] == 1.0
    assert effect("scan_time").insert(site, "controller", period=1.0) is site
    assert isinstance(put("scan_time", "controller", site, period=2.0)["controller"], SampledPI)
    log = run(put("controller_filter", "controller", site, tau=3.0))
    a, e_f, z, want = 1.0 - math.exp(-1.0 / 3.0), 0.0, 0.5, []
    for e in log["SP"] - log["PV"]:
        e_f += a * (e - e_f)
        z += 0.4 * e_f / 10.0
        want.append(0.4 * e_f + z)
    filters = effect("controller_filter").started(
        put("controller_filter", "controller", site, tau=3.0), "controller", {"SP": 1.5, "PV": 1.5}
    )
    log = run(filters)
    e_f, z, want = 0.0, 0.5, []
    for e in log["SP"] - log["PV"]:
        e_f += a * (e - e_f)
        z += 0.4 * e_f / 10.0
        want.append(0.4 * e_f + z)
    np.testing.assert_allclose(log["OP"], want, atol=1e-9)


def test_a_swinging_door_keeps_the_log_within_its_deviation_and_nothing_else():
    t = np.arange(200.0)
    log = Log(t=t, signals={"PV": np.sin(t / 9.0), "OP": np.cos(t / 9.0)})
    kept = effect("compression").on_log(log, deviation=0.05)
    assert np.abs(kept["PV"] - log["PV"]).max() <= 0.05 + 1e-12
    assert (kept["OP"] == log["OP"]).all() and swinging_door_kept(t, log["PV"], 0.05).sum() < 60
    assert effect("compression").insert(quiet(), "historian", deviation=0.05).signals == quiet().signals
    assert effect("stiction").on_log(log) is log and effect("compression").on_log(log) is log


def test_a_tank_runs_over_into_the_next():
    u = Recorded("u", [0.0, 400.0, 800.0], [3.0, 8.0, 2.0])
    tanks = wire([u, *cascaded_tanks().blocks])
    free = simulate(tanks, 800.0, every=1.0, **EXACT).log
    over = simulate(put("tank_overflow", "tank_1", tanks, level=10.0, share=0.3), 800.0, every=1.0, **EXACT).log
    assert free["h_1"].max() > 12.0 and over["h_1"].max() == pytest.approx(10.0, abs=1e-9)
    full = over["h_1"] > 10.0 - 1e-9
    lost = np.where(full, np.maximum(over["u"] - 1.2014 * np.sqrt(10.0), 0.0), 0.0)
    np.testing.assert_allclose(over["tank_1:tank_overflow/q_over"][1:-1], lost[1:-1], atol=1e-8)
    gained = 13.37 * np.gradient(over["h_2"], 1.0) + 1.2014 * np.sqrt(over["h_2"])  # what the lower tank got
    inner = full & np.roll(full, 1) & np.roll(full, -1) & (over.t != 400.0)  # u has a corner there
    np.testing.assert_allclose(gained[inner], (over["q_1"] + 0.3 * lost)[inner], atol=2e-4)
    last = simulate(put("tank_overflow", "tank_2", tanks, level=9.0), 800.0, every=1.0).log
    assert last["y"].max() == pytest.approx(9.0, abs=1e-9) and free["y"].max() > 10.0
