"""What changed between two times of a loop: pairs of another simulation, with one thing changed or nothing."""

import json
from dataclasses import replace

import pytest
from stickslip.remedy import changes, fit, lacks
from stickslip.remedy.together import PARTS, Pair

from benchmarks.remedy.plants import Plant

SAMPLES = 1_600


@pytest.fixture(scope="module")
def plant():
    drawn = Plant.drawn(12)  # Karnopp's stem, S = 7.6 %, J = 3.2 %
    return replace(drawn, sp=drawn.sp[:SAMPLES], load=drawn.load[:SAMPLES], noise=drawn.noise[:SAMPLES])


@pytest.fixture(scope="module")
def earlier(plant):
    return fit(plant.record())


@pytest.mark.parametrize("change", ["nothing", "stiction", "stiction_gone", "controller_gain"])
def test_the_change_is_named_and_nothing_else_of_valve_process_and_controller(plant, earlier, change):
    found = changes(earlier, fit(plant.later(change).record()))
    named = [one.effect for one in found.changed if one.effect not in ("disturbance", "sensor_noise")]
    assert named == ([] if change == "nothing" else [change.removesuffix("_gone")])
    assert found.gap == bool(found.changed)


@pytest.mark.parametrize(
    ("part", "other"),
    [
        ("stiction", lambda one: replace(one, S=2.0 * one.S, J=2.0 * one.J)),
        ("process_gain", lambda one: replace(one, K=2.0 * one.K)),
        ("process_time_constant", lambda one: replace(one, tau=3.0 * one.tau)),
        ("dead_time", lambda one: replace(one, theta=one.theta + 8.0)),
    ],
)  # fmt: skip
def test_the_part_in_which_loops_and_log_differ_gains_most(earlier, part, other):
    # the search for both times together found 0 nats: it let the loops of the earlier time go
    pair = Pair(replace(earlier, loops=tuple(other(one) for one in earlier.loops)), earlier)
    gains = {each: pair.gain(each) for each in PARTS}
    assert max(gains, key=lambda each: gains[each]) == part and gains[part] > 25.0


def test_a_retuned_controller_is_told_to_the_per_cent(plant, earlier):
    later = replace(earlier, controller=replace(earlier.controller, K_p=0.8 * earlier.controller.K_p))
    (only,) = changes(earlier, later).changed
    assert (only.effect, only.place) == ("controller_gain", "controller")
    assert only.ratio.value == pytest.approx(0.8, rel=0.01)
    assert not changes(earlier, earlier).gap


def test_a_loop_without_stick_lacks_one(earlier):
    found = lacks(earlier)
    assert found.gap and found.changed[0].effect == "stiction"
    json.dumps(found.to_dict(), allow_nan=False)
    assert {"gap", "where", "causes", "ranking"} <= set(found.to_dict())
    (said,) = found.words
    assert "went from" not in said and f"is {earlier.S} " in said
    without = lacks(replace(earlier, sticks=False, gain=-1.0))
    assert not without.gap and "changed" not in without.words[0]
