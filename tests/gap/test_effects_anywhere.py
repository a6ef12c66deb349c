"""Effects in any diagram: every place of every model, nested diagrams, two at once."""

import numpy as np
import pytest
from stickslip.blocks import FirstOrder, Noise, Sum
from stickslip.cases.models import CASES_BY_NAME, cascaded_tanks, ideal_flow, site_flow
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import CATALOGUE, effect

from tests.gap.effect_loops import SIZES, SP, put, quiet, run

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


def test_a_disturbance_is_sought_at_a_stated_load_in_the_unit_of_its_block():
    parts = [Sum("push", {"MV": 1.0, "load": 0.5}), FirstOrder(1.0, 5.0, inputs="push")]
    loaded = wire([*parts, Noise("load", sd=0.0, dt=1.0, name="wind")], inputs=["MV"])
    step = effect("step_disturbance")
    assert step.places(loaded) == ("wind",) and step.places(wire(parts, inputs=["MV", "load"])) == ()
    changed = step.insert(loaded, "wind", amplitude=4.0, time=10.0)
    log = simulate(changed, 100.0, every=1.0, inputs={"MV": 0.0}).log
    assert abs(log["load"][-1] - 4.0) < 1e-9  # analytic: 4 units of the load, half of which enters the process
    assert abs(log["PV"][-1] - 2.0) < 1e-6
