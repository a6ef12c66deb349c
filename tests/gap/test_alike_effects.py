"""Effects that no log of SP, PV and OP tells apart, and loops in which they differ."""

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.cases.models import level_cascade, level_loop
from stickslip.diagram import simulate
from stickslip.gap.effects import effect

from tests.gap.effect_loops import EXACT, EXACTLY, LOGGED, put, quiet, run


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
