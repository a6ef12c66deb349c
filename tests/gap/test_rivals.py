"""A named effect has to suit a record better than generic rivals, which are in no catalogue."""

import math

import pytest
import stickslip.gap.likelihood.judge as judge
from stickslip.cases.models import site_flow
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.candidates import by_score
from stickslip.gap.likelihood.framing import frame_of, when_switched
from stickslip.gap.likelihood.judge import judged
from stickslip.gap.likelihood.rivals import beside_random, likelier
from stickslip.gap.likelihood.search import fitted, legal, model_alone
from stickslip.gap.likelihood.settling import settled
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import read

from tests.gap.aerated_tank import aerated_model
from tests.gap.outside_loops import site_log


def fits(kind, name):
    """Return the fits of the model alone and of one effect to a log of the loop in plain Python."""
    null = settled(model_alone(when_switched(frame_of(*read(site_flow(), site_log(kind))))))
    (fit, *_) = fitted(null, by_score(null, legal(null, [effect(name)])), False)
    return null, fit


def test_a_gain_that_follows_the_plan_of_a_sine_is_likelier_than_the_sine_where_it_is_true():
    null, fit = fits("a gain that oscillates", "sine_disturbance")
    assert likelier(fit, null) == "plan_of_sine_disturbance at valve"


@pytest.mark.parametrize(("kind", "name"), [("sine", "sine_disturbance"), ("step", "step_disturbance")])
def test_no_rival_is_likelier_than_a_true_load_nor_left_beside_it(kind, name):
    null, fit = fits(kind, name)
    assert likelier(fit, null) == ""
    alone = judged(fit, [])
    assert beside_random(fit, alone) == alone


def test_a_random_signal_is_left_beside_a_step_where_a_slow_load_is_true():
    _, fit = fits("a slow load", "step_disturbance")
    verdict = beside_random(fit, judged(fit, []))
    assert verdict.name == "a random signal at feed"
    assert verdict.unusual


@pytest.mark.parametrize("ended", [0, 5, 11])
def test_of_a_model_of_which_most_runs_come_to_no_end_nothing_is_usual(monkeypatch, ended):
    null = settled(model_alone(when_switched(frame_of(*read(site_flow(), site_log("sine"))))))
    whole = judge.without_gap
    monkeypatch.setattr(judge, "without_gap", lambda *asked: whole(*asked)[:ended])
    assert judged(null, []).limit == math.inf


def test_an_effect_beside_another_is_sought_where_it_can_be_still():
    # a slug enters the process by its own signal: which one a dead time would delay is not clear any more
    model = aerated_model()
    slug = effect("slug")
    sizes = {"amplitude": 0.01, "period": 900.0, "phase": 0.0}
    assert Given(model).places(effect("dead_time")) == ("process",)
    both = Given(model).with_part(slug.put(model, "feed"), slug, "feed", sizes, True)
    for place in both.places(effect("dead_time")):
        effect("dead_time").put(both.model, place)
