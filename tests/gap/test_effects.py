"""Every effect of the catalogue: what it does, by a closed form or a loop wired by hand; what is alike; refusals."""

import math

import numpy as np
import pytest

from blocks import FirstOrder, Recorded, SampledPI, Staircase
from cases.models import CASES_BY_NAME, cascaded_tanks, ideal_flow, level_cascade, level_loop, site_flow
from diagram import simulate, wire
from gap.effect import EffectError
from gap.effects import CATALOGUE, effect
from logs import Log
from logs.dirt import swinging_door_kept

EXACT = {"rtol": 1e-12, "atol": 1e-14}
SP, T = Staircase("SP", [1.5, 1.8, 1.35, 1.65], dwell=100.0), 400.0
LOGGED = ("SP", "PV", "OP")


def quiet(model=ideal_flow, sp=SP, rest=1.5):
    """Return a loop without its noises, driven by a staircase."""
    loop = model(rest=rest)
    return wire([sp, *loop.with_params({f"{b.name}.sd": 0.0 for b in loop.blocks if "sd" in b.params}).blocks])


def run(diagram, **keywords):
    return simulate(diagram, T, every=1.0, **{**EXACT, **keywords}).log


def put(name, place, loop=None, **values):
    return effect(name).insert(quiet() if loop is None else loop, place, **values)


# a small and a plain size of every effect of a loop: near the neutral values, and well away from them
SIZES = {
    "stiction": ("valve", {"S": 1e-7, "J": 5e-8}, {"S": 5.0, "J": 2.0}),
    "deadband": ("valve", {"width": 1e-7}, {"width": 3.0}),
    "valve_leak": ("valve", {"flow": 1e-7}, {"flow": 2.0}),
    "valve_saturation": ("valve", {"low": 1e-7}, {"high": 55.0}),
    "valve_rate_limit": ("valve", {"rate": 1e9}, {"rate": 1.0}),
    "positioner_lag": ("valve", {"tau": 1e-7}, {"tau": 3.0}),
    "valve_characteristic": ("valve", {"rangeability": 1.0 + 1e-8}, {"rangeability": 10.0}),
    "valve_gain": ("valve", {"factor": 1.0 + 1e-8}, {"factor": 1.2}),
    "dead_time": ("process", {"theta": 0.02}, {"theta": 3.0}),
    "process_gain": ("process", {"factor": 1.0 + 1e-8}, {"factor": 1.2}),
    "process_time_constant": ("process", {"factor": 1.0 + 1e-8}, {"factor": 1.3}),
    "second_lag": ("process", {"tau": 1e-7}, {"tau": 3.0}),
    "sensor_bias": ("sensor", {"offset": 1e-8}, {"offset": -0.1}),
    "sensor_drift": ("sensor", {"rate": 1e-8}, {"rate": 0.5}),
    "sensor_span": ("sensor", {"factor": 1.0 + 1e-8}, {"factor": 1.1}),
    "sensor_lag": ("sensor", {"tau": 1e-7}, {"tau": 3.0}),
    "quantisation": ("sensor", {"step": 1e-3}, {"step": 0.05}),
    "sensor_saturation": ("sensor", {"high": 1e9}, {"high": 1.6}),
    "controller_gain": ("controller", {"factor": 1.0 + 1e-8}, {"factor": 1.5}),
    "controller_integral_time": ("controller", {"factor": 1.0 + 1e-8}, {"factor": 1.5}),
    "controller_limits": ("controller", {"low": 1e-8}, {"high": 58.0}),
    "controller_filter": ("controller", {"tau": 1e-7}, {"tau": 3.0}),
    "scan_time": ("controller", {"period": 1e-4}, {"period": 4.0}),
    "sine_disturbance": ("feed", {"amplitude": 1e-8, "period": 60.0}, {"amplitude": 0.05, "period": 60.0}),
    "step_disturbance": ("feed", {"amplitude": 1e-8, "time": 50.0}, {"amplitude": 0.05, "time": 50.0}),
    "slug": ("feed", {"amplitude": 1e-8, "period": 90.0}, {"amplitude": 0.05, "period": 90.0}),
}
ELSEWHERE = {"tank_overflow", "sensor_noise", "compression"}
EXACTLY = {"first": {"SP": 1.5, "PV": 1.5, "OP": 0.5}}


def test_every_effect_is_tried():
    of_plant = {one.name for one in CATALOGUE if not any(one.places(case.build()) for case in CASES_BY_NAME.values())}
    assert {one.name for one in CATALOGUE} == {*SIZES, *ELSEWHERE, *of_plant}
    assert len(of_plant) == 10 and len(CATALOGUE) == len({one.name for one in CATALOGUE})


@pytest.mark.parametrize("name", SIZES)
def test_it_goes_to_nothing_near_its_neutral_values_and_only_there(name):
    place, small, plain = SIZES[name]
    one = effect(name)
    coarse = {"rtol": 1e-9, "atol": 1e-11} if name in ("scan_time", "quantisation") else EXACT
    still = quiet()
    neutral = one.nominal(still, place)
    assert one.insert(still, place, **neutral) is still and one.insert(still, place) is still
    nearly = one.started(one.insert(still, place, **small), place, EXACTLY["first"])
    other = one.started(one.insert(still, place, **plain), place, EXACTLY["first"])
    assert set(still.open_inputs) == set(nearly.open_inputs) and nearly.declared_outputs == still.declared_outputs
    times = np.arange(0.5, T)  # not at the instants at which SP jumps
    base, tiny, seen = (simulate(d, T, times=times, **coarse).log for d in (still, nearly, other))
    near = max(np.abs(tiny[s] - base[s]).max() for s in LOGGED)
    away = max(np.abs(seen[s] - base[s]).max() for s in LOGGED)
    assert near < {"dead_time": 5e-3, "quantisation": 3e-3, "scan_time": 1e-4}.get(name, 5e-6) < away
    assert 3.0 * near < away and away > 1e-3


@pytest.mark.parametrize("name", [name for name in SIZES if name != "sensor_noise"])
def test_settings_are_the_insertion(name):
    place, small, plain = SIZES[name]
    still = quiet()
    once = effect(name).insert(still, place, **small)
    full = {p.name: effect(name).nominal(still, place)[p.name] for p in effect(name).parameters} | plain
    assert (
        once.with_params(effect(name).settings(still, place, **full)).params == put(name, place, still, **plain).params
    )


# --- what each does, by hand ------------------------------------------------------------------------------------------
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
    from blocks import Constant, Sum

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
    np.testing.assert_allclose(over["over_1"][1:-1], lost[1:-1], atol=1e-8)
    gained = 13.37 * np.gradient(over["h_2"], 1.0) + 1.2014 * np.sqrt(over["h_2"])  # what the lower tank got
    inner = full & np.roll(full, 1) & np.roll(full, -1) & (over.t != 400.0)  # u has a corner there
    np.testing.assert_allclose(gained[inner], (over["q_1"] + 0.3 * lost)[inner], atol=2e-4)
    last = simulate(put("tank_overflow", "tank_2", tanks, level=9.0), 800.0, every=1.0).log
    assert last["y"].max() == pytest.approx(9.0, abs=1e-9) and free["y"].max() > 10.0


# --- what no log of SP, PV and OP tells apart -------------------------------------------------------------------------
def same(*made):
    first, *others = (run(diagram) for diagram in made)
    return max(np.abs(first[s] - other[s]).max() for other in others for s in LOGGED)


def test_gains_of_valve_process_and_sensor_are_one_class():
    loop = quiet(rest=0.0)
    made = [
        put(*at, loop, factor=1.2)
        for at in (("valve_gain", "valve"), ("process_gain", "process"), ("sensor_span", "sensor"))
    ]
    assert same(*made) < 1e-12 < 1e-2 < same(loop, made[0])


def test_lags_of_positioner_process_and_sensor_are_one_class():
    loop, first = quiet(), EXACTLY["first"]
    places = (("positioner_lag", "valve"), ("second_lag", "process"), ("sensor_lag", "sensor"))
    made = [effect(name).started(put(name, at, loop, tau=3.0), at, first) for name, at in places]
    assert same(*made) < 1e-10 < 1e-2 < same(loop, made[0])


def test_a_leak_a_bias_and_a_step_from_the_start_are_one_class():
    up = quiet().starting_at({"process.PV": 1.56})  # what a leak has filled in before the start
    made = [
        put("valve_leak", "valve", up, flow=2.0),
        put("step_disturbance", "feed", up, amplitude=0.02, time=0.0),
        put("sensor_bias", "sensor", offset=0.06),
    ]
    assert same(*made) < 1e-12 < 1e-3 < same(up, made[0])


@pytest.mark.parametrize(
    ("model", "group", "other"),
    [
        (level_loop, {"process_gain": 1.25, "process_time_constant": 0.8, "sensor_span": 1.25}, {"valve_gain": 1.25}),
        (level_cascade, {"valve_gain": 1.25, "process_gain": 1.25}, {"sensor_span": 1.25}),
    ],
)
def test_other_loops_have_other_classes(model, group, other):
    outer = Staircase("SP_L" if model is level_cascade else "SP", [0.5, 0.55, 0.47], dwell=500.0)
    loop = quiet(model, outer, 0.5)
    logged = ("SP", "PV", "OP", "L") if model is level_cascade else LOGGED

    def log(name, factor):
        place = PLACES[name]
        changed = effect(name).insert(loop, place, factor=factor)
        if model is level_loop and name == "sensor_span":
            changed = changed.starting_at({"process.PV": 0.5 / factor})
        return simulate(changed, 1500.0, every=5.0, **EXACT).log

    logs = [log(*one) for one in group.items()]
    assert max(np.abs(logs[0][s] - one[s]).max() for one in logs for s in logged) < 1e-9
    apart = [log(*one) for one in other.items()]
    assert max(np.abs(logs[0][s] - one[s]).max() for one in apart for s in logged) > 1e-3


PLACES = {
    "valve_gain": "valve",
    "sensor_span": "sensor",
    **dict.fromkeys(("process_gain", "process_time_constant"), "process"),
}


# --- in any diagram ---------------------------------------------------------------------------------------------------
LEGAL = [
    (name, one.name, place)
    for name, case in CASES_BY_NAME.items()
    for built in [case.build()]
    for one in CATALOGUE
    for place in one.places(built)
]


@pytest.mark.parametrize(("model", "name", "place"), LEGAL)
def test_every_effect_runs_at_every_place_of_every_model(model, name, place):
    built, one = CASES_BY_NAME[model].build(), effect(name)
    low, high = one.bounds(built, place)[one.parameters[0].name]
    values = {"tank_overflow": {"level": 9.0, "share": 0.5}}.get(name) or dict(SIZES.get(name, ("", {}, {}))[2])
    if name == "sensor_noise":
        values = {"factor": 2.0}
    changed = one.started(one.insert(built, place, **values), place, {})
    assert changed.open_inputs == built.open_inputs and set(built.signals) <= set(changed.signals)
    assert changed.tolerances == built.tolerances
    assert low < high and (one.of_log or changed is not built)
    logged = simulate(changed, 200.0, every=5.0)
    assert logged.ok and all(np.isfinite(logged.log[s]).all() for s in logged.log.names)


def test_places_are_found_in_other_diagrams_too():
    found = {(name, place) for model, name, place in LEGAL if model == "level_cascade"}
    assert {("controller_gain", "controller"), ("controller_gain", "level_controller")} <= found
    assert {("sensor_bias", "sensor"), ("sensor_bias", "level_sensor"), ("dead_time", "vessel")} <= found
    assert {place for name, place in found if name == "step_disturbance"} == {"feed"}


# --- refusals ---------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("deadband", {"width": -1.0}, "width = -1, but it must be finite and at least 0; give 0 for none"),
        ("valve_leak", {"flow": math.inf}, "flow = inf, but it must be finite"),
        (
            "valve_saturation",
            {"low": 70.0, "high": 60.0},
            "low = 70 %, high = 60 %, but .* low below high; correct them",
        ),
        ("valve_rate_limit", {"rate": 0.0}, "rate = 0 %/s, but a stem that moves has a rate above 0"),
        ("positioner_lag", {"tau": -1.0}, "tau = -1"),
        ("valve_characteristic", {"rangeability": 0.0}, "rangeability = 0, but it must be finite and above 0; give 1"),
        ("valve_gain", {"factor": -1.0}, "factor = -1"),
        ("dead_time", {"theta": -1.0}, "theta = -1"),
        ("process_gain", {"factor": 0.0}, "factor = 0"),
        ("process_time_constant", {"factor": 0.0}, "factor = 0"),
        ("second_lag", {"tau": -1.0}, "tau = -1"),
        ("sensor_bias", {"offset": math.inf}, "offset = inf, but it must be finite; give 0 for none"),
        ("sensor_drift", {"rate": math.inf}, "rate = inf"),
        ("sensor_span", {"factor": 0.0}, "factor = 0"),
        ("sensor_lag", {"tau": -1.0}, "tau = -1"),
        ("quantisation", {"step": -0.1}, "step = -0.1"),
        ("sensor_saturation", {"low": 2.0, "high": 1.0}, "low = 2, but it must be below high = 1; correct them"),
        ("controller_gain", {"factor": 0.0}, "factor = 0"),
        ("controller_integral_time", {"factor": 0.0}, "factor = 0"),
        ("controller_limits", {"low": 90.0, "high": 60.0}, "low = 90 %, but it must be below high = 60 %"),
        ("controller_filter", {"tau": -1.0}, "tau = -1"),
        ("scan_time", {"period": -1.0}, "period = -1"),
        ("scan_time", {"period": 1.0, "present": 0.5}, "present = 0.5, but it is 0 or 1"),
        ("scan_time", {"period": 1.0, "offset": -1.0}, "the first scan is at 0 s or later"),
        ("sine_disturbance", {"amplitude": 0.1, "period": 0.0}, "period = 0, but .* above 0; give seconds"),
        ("step_disturbance", {"amplitude": math.inf}, "amplitude = inf"),
        ("slug", {"amplitude": -0.1}, "amplitude = -0.1"),
    ],
)
def test_values_that_it_cannot_have_are_refused(name, values, said):
    with pytest.raises(EffectError, match=said):
        effect(name).insert(quiet(), SIZES[name][0], **values)


def test_tanks_noise_and_compression_refuse_too():
    for name, place, loop, values in (
        ("tank_overflow", "tank_1", cascaded_tanks(), {"level": 0.0}),
        ("tank_overflow", "tank_1", cascaded_tanks(), {"level": 5.0, "share": 2.0}),
        ("sensor_noise", "sensor", ideal_flow(), {"factor": -1.0}),
        ("compression", "historian", ideal_flow(), {"deviation": -1.0}),
        ("sensor_noise", "sensor", quiet(), {"factor": 2.0}),
    ):
        with pytest.raises(EffectError):
            effect(name).insert(loop, place, **values)
    with pytest.raises(EffectError, match="deviation = -1"):
        effect("compression").on_log(Log(t=[0.0, 1.0], signals={"PV": [0.0, 1.0]}), deviation=-1.0)


def test_places_of_the_models():
    for model in (ideal_flow(), site_flow()):
        for name, (place, _, _) in SIZES.items():
            assert effect(name).places(model) == (place,), name
        assert effect("compression").places(model) == ("historian",) and effect("sensor_noise").places(model) == (
            "sensor",
        )
    tanks = cascaded_tanks()
    assert effect("tank_overflow").places(tanks) == ("tank_1", "tank_2")
    assert effect("sensor_saturation").places(tanks) == ("sensor",) and effect("valve_gain").places(tanks) == ("pump",)


def test_effects_go_into_nested_diagrams_and_pairs_too():
    both = wire([ideal_flow(rest=1.5).named("a", SP="SP"), site_flow(rest=1.5).named("b", SP="SP"), SP])
    for name, (place, _, plain) in SIZES.items():
        one = effect(name)
        assert one.places(both) == (f"a/{place}", f"b/{place}")
        both_again = one.insert(one.insert(both, f"a/{place}", **plain), f"b/{place}", **plain)
        assert simulate(both_again, 20.0, every=5.0).ok
    loop = quiet()
    for first, then in (("stiction", "valve_gain"), ("valve_gain", "stiction"), ("sensor_lag", "sensor_bias")):
        once = effect(first).insert(loop, SIZES[first][0], **SIZES[first][2])
        twice = effect(then).insert(once, SIZES[then][0], **SIZES[then][2])
        assert simulate(twice, 20.0, every=5.0).ok
    pair = put("valve_gain", "valve", put("stiction", "valve", S=5.0, J=2.0), factor=1.2)
    swapped = put("stiction", "valve", put("valve_gain", "valve", factor=1.2), S=5.0, J=2.0)
    one, other = run(pair), run(swapped)
    np.testing.assert_allclose(one["PV"], other["PV"], atol=1e-9)  # the stem before, the gain behind it, either way
    assert (one["MV"] == other["MV"]).all() and np.abs(one["PV"] - run(loop)["PV"]).max() > 0.01
