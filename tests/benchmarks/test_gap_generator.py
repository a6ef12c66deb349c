"""The generator of the gap's benchmark against the diagrams of the house: two programs, one loop, and every effect.

Where they agree each is the other's oracle; they share no code, no integrator and no law of friction.
"""

import ast
import math
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from stickslip.blocks import Recorded
from stickslip.cases.models import ideal_flow, level_cascade, level_loop, second_order_flow, site_flow
from stickslip.diagram import simulate, wire
from stickslip.diagram.pins import replay, residuals
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.logs import Log

from benchmarks.gap import friction, generator, severities
from benchmarks.gap.generator import FAMILIES, record
from tests.gap.test_controllers_of_others import SIZES as OF_OTHERS

ROOM = Path(generator.__file__).parent
HOURS = 0.2
PLACE = {"valve": "valve", "process": "process", "sensor": "sensor", "controller": "controller", "disturbance": "feed"}


def model(made, name=""):
    """Return the loop of a record without noise, at rest where the record starts."""
    rest = float(made.set_point[0])
    loop = MODELS[made.setting](rest=rest)
    quiet = {f"{b.name}.sd": 0.0 for b in loop.blocks if "sd" in b.params}
    loop = loop.with_params({**quiet, **within(made)})
    opening = (0.5 if made.setting == "cascade" else rest) / made.numbers["K"]
    opening = 0.5 if made.setting == "level" else opening
    loop = loop.starting_at({"controller.z": opening})
    if loop["process"].dead_time:
        loop = loop.with_params({"process.theta_start": opening})
    if name:
        one = effect(name)
        place = PLACE[str(one.role)]
        seen = 0.5 if made.setting == "cascade" else rest
        first = {"SP": seen, "PV": seen, "OP": opening, "MV": opening}
        loop = one.started(one.insert(loop, place, **made.effects[name]), place, first)
    sp = Recorded(loop.open_inputs[0], np.arange(float(len(made.set_point))), made.set_point, hold="previous")
    return wire([sp, *loop.blocks])


def within(made):
    """Return the true values of what a model knows within tolerances."""
    base = made.base
    if made.setting == "second_order":
        return {"process.K": base["K"], "process.omega": 1.0 / math.sqrt(base["tau"] * base["second"])}
    if made.setting == "level":
        return {"process.T": base["tau"]}
    return {f"process.{key}": base[key] for key in ("K", "tau")} if made.setting in ("site", "cascade") else {}


MODELS = {
    "ideal": ideal_flow, "coarse": ideal_flow, "site": site_flow, "second_order": second_order_flow,
    "level": level_loop, "cascade": level_cascade,
}  # fmt: skip


def again(made, name=""):
    t = made.signals["time"]
    return simulate(model(made, name), float(t[-1]), times=t, rtol=1e-8, atol=1e-10).log


def worst(made, name=""):
    log = again(made, name)
    return max(float(np.abs(log[s] - made.signals[s]).max()) for s in ("PV", "OP"))


def test_it_shares_no_code_with_what_it_judges():
    allowed = {"benchmarks", "numpy", "numba", "math", "collections", "dataclasses", "pathlib", "typing"}
    for name in ("physics", "severities", "generator", "settings", "friction", "compressor"):
        for node in ast.walk(ast.parse((ROOM / f"{name}.py").read_text())):
            if isinstance(node, ast.Import | ast.ImportFrom):
                names = [a.name for a in node.names] if isinstance(node, ast.Import) else [node.module or ""]
                assert {n.split(".")[0] for n in names} <= allowed


def test_every_effect_of_a_loop_has_sizes():
    elsewhere = {"sensor_saturation", *OF_OTHERS}  # a plant in plain numpy has these (tests/gap/plain_tank.py)
    named = {one.name for one in CATALOGUE if one.places(ideal_flow())} - elsewhere
    assert set(severities.IDEAL) == set(severities.SITE) == named
    sets = severities.OUTSIDE_FOR_TUNING, severities.OUTSIDE_FOR_REPORT, severities.NEVER_SEEN, severities.NAMED_NOW
    assert sorted(kind for one in sets for kind in one) == sorted(severities.OUTSIDE)


def test_without_an_effect_both_programs_run_one_loop():
    assert worst(record("ideal", seed=3, hours=HOURS, noise=False)) < 2e-6  # half of a rounding of 1e-6, and steps
    assert worst(record("coarse", seed=3, hours=HOURS, noise=False)) < 0.52e-3


@pytest.mark.parametrize("setting", ["site", "second_order", "level", "cascade"])
def test_the_loops_of_sites_too(setting):
    assert worst(record(setting, seed=3, hours=1.0, noise=False)) < 0.78e-3


EXACT = {  # how far apart the programs may be, where steps of 0.01 s see a kink late
    "valve_rate_limit": 1e-3, "deadband": 1e-4, "dead_time": 5e-5, "valve_saturation": 5e-5,
    "controller_limits": 2e-4,
}  # fmt: skip
BY_HAND = {"stiction", "sensor_noise", "compression", "quantisation"}


@pytest.mark.parametrize("name", [n for n in severities.IDEAL if n not in BY_HAND])
def test_the_catalogue_s_effect_is_the_generator_s(name):
    made = record("ideal", [name], "gross", seed=5, hours=HOURS, noise=False)
    apart, gap = worst(made, name), worst(made)
    assert gap > 1e-3 and apart < EXACT.get(name, 5e-6) < 0.1 * gap


PINNED = (
    "deadband", "valve_leak", "valve_characteristic", "dead_time", "process_gain", "second_lag", "sensor_drift",
    "sensor_lag", "controller_integral_time", "controller_filter", "scan_time", "slug",
)  # fmt: skip


@pytest.mark.parametrize("name", PINNED)
def test_a_pinned_replay_with_the_true_effect_leaves_noise_and_rounding(name):
    made = record("ideal", [name], "typical", seed=1, hours=0.25)
    log = Log(t=made.signals["time"], signals={s: made.signals[s] for s in ("SP", "PV", "OP")})

    def left(loop):
        found = residuals(replay(loop.without("SP"), log))
        return np.sqrt(np.mean(found["PV"][100:] ** 2)), np.median(np.abs(np.diff(found["OP"])[100:]))

    noise, steps = left(model(made, name))
    assert noise == pytest.approx(0.004, rel=0.1)  # what was drawn for the sensor
    assert steps < 6e-7  # a log rounded to 1e-6: the median of what is left of OP is a third of that
    assert left(model(made))[1] > 2.0 * steps or left(model(made))[0] > 1.5 * noise


@pytest.mark.parametrize("law", friction.LAWS)
@pytest.mark.parametrize(("S", "J"), [(0.03, 0.01), (0.06, 0.04)])
def test_the_figure_shows_S_and_J(law, S, J):
    numbers = friction.with_friction(S, J, law)
    seen = friction.figure(numbers)
    assert seen == pytest.approx((S, J), rel=0.12)  # analytic for a slow stem: (F_s +- F_c)/k


@pytest.mark.parametrize("law", friction.LAWS)
@pytest.mark.parametrize("seed", range(2))
def test_stiction_of_the_catalogue_is_near_other_laws_of_friction(seed, law):
    given = {"stiction": {"S": 6.0, "J": 2.5, "law": law}}
    made = record("ideal", ["stiction"], seed=seed, hours=0.4, noise=False, given=given)
    assert made.effects["stiction"] == pytest.approx({"S": 6.0, "J": 2.5}, rel=0.1)
    op = Recorded("OP", made.signals["time"], made.signals["OP"])
    bench, one = wire([op, ideal_flow()["valve"]]), effect("stiction")
    sticky = one.insert(bench, "valve", **made.effects["stiction"])
    sticky = one.started(sticky, "valve", {"MV": float(made.signals["MV"][0])})
    log = simulate(sticky, 1440.0, times=made.signals["time"]).log
    missed = np.abs(log["MV"] - made.signals["MV"])[100:]
    free = np.abs(made.signals["OP"] - made.signals["MV"])[100:]
    # where it slips a second apart from the other law it is wrong until the next slip; bristles slip again and again
    assert law == friction.LUGRE or np.median(missed) < 0.05 * np.median(free)
    assert np.sqrt(np.mean(missed**2)) < 0.9 * np.sqrt(np.mean(free**2))


def test_a_converter_s_edges_are_crossed_at_the_same_time_but_for_chatter():
    made = record("ideal", ["quantisation"], "gross", seed=5, hours=HOURS, noise=False)
    missed = np.abs(again(made, "quantisation")["PV"] - made.signals["PV"])
    assert np.median(missed) < 2e-6 and np.mean(missed > 1e-3) < 0.4  # it chatters along an edge
    assert np.mean(np.abs(again(made)["PV"] - made.signals["PV"]) > 1e-3) > 0.9


def test_compression_and_noise_act_as_the_catalogue_says():
    plain = record("ideal", seed=5, hours=HOURS)
    kept = record("ideal", ["compression"], "gross", seed=5, hours=HOURS)
    log = Log(t=kept.clean["time"], signals={"PV": kept.clean["PV"]})
    same = effect("compression").on_log(log, **kept.effects["compression"])
    assert np.abs(same["PV"] - kept.signals["PV"]).max() < 2e-3  # a door may close a sample earlier after the rounding
    assert np.mean(np.abs(same["PV"] - kept.signals["PV"]) < 2e-6) > 0.9
    loud = record("ideal", ["sensor_noise"], "typical", seed=5, hours=HOURS)
    steps = [np.median(np.abs(np.diff(one["PV"]))) for one in (loud.signals, loud.clean)]  # hardly of the set point
    ratio = steps[0] / steps[1]
    assert ratio == pytest.approx(loud.effects["sensor_noise"]["factor"], rel=0.1)
    assert plain.gap == 0.0 < kept.gap


@pytest.mark.parametrize(
    "name", ["valve_gain", "sensor_lag", "controller_filter", "scan_time", "sine_disturbance", "dead_time"]
)
def test_the_site_s_effects_too(name):
    made = record("site", [name], "gross", seed=7, hours=0.5, noise=False)
    assert worst(made, name) < 1.6e-3 < worst(made)


@pytest.mark.parametrize(
    ("setting", "name"),
    [
        ("second_order", "process_time_constant"), ("second_order", "second_lag"), ("second_order", "dead_time"),
        ("level", "process_gain"), ("level", "process_time_constant"), ("level", "valve_leak"),
        ("cascade", "sensor_span"), ("cascade", "valve_gain"), ("cascade", "second_lag"),
    ],
)  # fmt: skip
def test_the_effects_of_other_loops_too(setting, name):
    made = record(setting, [name], "gross", seed=7, hours=0.5, noise=False)
    assert worst(made, name) < 1.6e-3 < worst(made)


def test_seeds_of_tuning_and_report_are_kept_apart():
    many = [record("ideal", seed=1, hours=HOURS, family=f).signals["PV"] for f in FAMILIES]
    assert len(many) >= 4 and min(np.abs(a - b).max() for a, b in combinations(many, 2)) > 0.01
    same = record("ideal", seed=1, hours=HOURS).signals["PV"]
    np.testing.assert_array_equal(many[0], same)


def test_sizes_are_in_order_and_visible():
    for name in ("valve_gain", "sensor_bias", "second_lag", "slug"):
        gaps = [record("ideal", [name], s, seed=2, hours=0.25).gap for s in severities.SEVERITIES]
        assert 0.02 < gaps[0] < gaps[1] < gaps[2]


@pytest.mark.parametrize("kind", severities.OUTSIDE)
def test_what_is_outside_the_catalogue_leaves_a_trace(kind):
    made = record("ideal", severity="gross", seed=2, hours=0.25, outside=kind)
    assert made.gap > 0.5 and all(np.isfinite(values).all() for values in made.signals.values())


def test_words_that_are_none_are_refused(tmp_path):
    for arguments in (
        {"setting": "plant"},
        {"setting": "ideal", "severity": "huge"},
        {"setting": "ideal", "outside": "x"},
    ):
        with pytest.raises(ValueError, match="is none of"):
            record(**arguments, hours=HOURS)
    record("coarse", seed=1, hours=HOURS).write(tmp_path / "run.csv")
    table = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    assert table.dtype.names == ("time", "SP", "PV", "OP") and math.isclose(table["time"][-1], 720.0)
    np.testing.assert_allclose(table["PV"], np.round(table["PV"], 3), atol=1e-12)
