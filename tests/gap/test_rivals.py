"""Generic rivals and parameters that change along a record: what keeps an unknown effect from a known name."""

import numpy as np
import pytest
from stickslip.cases.models import site_flow
from stickslip.gap import diagnose
from stickslip.gap.answers.sureness import Sureness
from stickslip.gap.effects import effect
from stickslip.gap.filters.adequacy import LIMIT, rival, worst
from stickslip.gap.filters.checks import known_of
from stickslip.gap.filters.constant import modulated, stretches
from stickslip.gap.filters.diagnosing import filtering_of, outcome
from stickslip.gap.filters.explaining import coarse, followed, settled
from stickslip.gap.filters.filtering import Explanation
from stickslip.gap.filters.growing import growing
from stickslip.gap.filters.rivals import beside
from stickslip.gap.filters.telling import told
from stickslip.gap.records.model import Nuisance, read

from tests.gap.outside_loops import KINDS, site_log

FEW = ("step_disturbance", "sine_disturbance", "sensor_drift", "sensor_noise", "process_gain", "second_lag")
CATALOGUE = [effect(name) for name in FEW]
HOURS = {"a ramp of the load": 2.0}  # with less behind it, a ramp is a step
KNOWN = {
    "none": [],
    "step": ["step_disturbance"],
    "sine": ["sine_disturbance"],
    "more noise": ["sensor_noise"],
}


def filtered_as_it_is(kind):
    return settled(filtering_of(*read(site_flow(), site_log(kind)))).best


@pytest.mark.parametrize("kind", KINDS)
def test_what_no_catalogue_has_is_unknown_and_what_it_has_is_named(kind):
    # what a diagnosis adds, a search for mistakes in the log, takes as long and has its own tests
    log = site_log(kind, hours=HOURS.get(kind, 1.5))
    report = told(outcome(filtering_of(*read(site_flow(), log)), CATALOGUE), Sureness())
    assert [cause.effect for cause in report.causes] == KNOWN.get(kind, ["unknown"])


def test_a_diagnosis_says_which_generic_rival_keeps_a_name_from_a_record():
    report = diagnose(site_flow(), site_log("a gain that switches"), catalogue=CATALOGUE, progress=False)
    assert "lower than that of a gain that follows the same plan, no effect of the catalogue" in str(report)


def test_what_parameters_do_already_is_no_change_of_theirs():
    # e in the span of the slopes: its part beside them is 0 (analytic)
    rng = np.random.default_rng(1)
    slopes = {"a": rng.normal(size=(900, 2)), "b": rng.normal(size=(900, 2))}
    e = 3.0 * slopes["a"] - 2.0 * slopes["b"]
    found = modulated(e, slopes, {"level": rng.normal(size=900)} | stretches(900))
    assert len(found) == 14
    assert max(map(abs, found.values())) < 1e-9


def test_figures_of_change_are_normal_where_nothing_changes():
    rng = np.random.default_rng(2)
    slopes = {"a": rng.normal(size=(400, 2)), "b": np.cumsum(rng.normal(size=(400, 2)), axis=0)}
    known = {"level": np.sin(np.arange(400) / 30.0)} | stretches(400)
    many = np.array([list(modulated(rng.normal(size=(400, 2)), slopes, known).values()) for _ in range(800)])
    assert np.abs(many.mean(axis=0)).max() < 0.15  # standard error 0.035
    assert np.abs(many.std(axis=0) - 1.0).max() < 0.1  # standard error 0.025


def test_a_size_that_goes_with_a_level_is_seen():
    rng = np.random.default_rng(3)
    d, g = rng.normal(size=(900, 1)), np.sin(np.arange(900.0))
    found = modulated(rng.normal(size=(900, 1)) + 0.3 * d * g[:, None], {"a": d}, {"level": g})
    # expected 0.3 |d g| = 0.3 sqrt(900) in units of g's own size sqrt(1/2): 6.4, standard deviation 1
    assert found["a with level"] == pytest.approx(0.3 * np.sqrt(900.0 / 2.0), abs=4.0)


def test_two_random_signals_at_a_block_are_one_of_their_joint_variance():
    now = filtered_as_it_is("none")
    one = now.explanation
    two = (Nuisance("feed", 0.003, 0.0), Nuisance("feed", 0.004, 0.0))
    both = Explanation(one.filtering, beside=two).filtered(now.values)
    joint = Explanation(one.filtering, beside=(Nuisance("feed", 0.005, 0.0),)).filtered(now.values)
    assert both.nll == pytest.approx(joint.nll, abs=1e-6)


def test_nothing_is_gained_beside_a_right_explanation_and_much_beside_a_wrong_one():
    assert max(beside(filtered_as_it_is("none")).values()) < 3.0
    assert max(beside(filtered_as_it_is("a restless stem")).values()) > 9.0


def test_the_same_plan_at_the_gain_is_worse_for_a_load_and_better_for_a_gain():
    for kind, right in (("step", True), ("a gain that switches", False)):
        f = settled(filtering_of(*read(site_flow(), site_log(kind)))).best.explanation.filtering
        one = followed(coarse(settled(f), effect("step_disturbance"), "feed"))
        other = rival(one.best)
        assert (other.behind > 6.0) == right
        assert right or other.name == "a gain that follows the same plan"
        assert (worst(one.best)[1] <= LIMIT) == right


def test_noise_that_grows_with_the_level_is_told_from_more_noise():
    for kind, right in (("more noise", True), ("a noise that grows with the level", False)):
        plain = settled(filtering_of(*read(site_flow(), site_log(kind))))
        one = followed(coarse(plain, effect("sensor_noise"), "sensor"))
        (loss,) = growing(one.best).values()
        assert (loss > one.nll + 4.0) == right
        assert (loss < one.nll - 4.0) != right
    assert growing(followed(coarse(plain, effect("process_gain"), "process")).best) == {}


def test_what_rows_are_known_by_has_no_mean():
    known = known_of(filtered_as_it_is("none"))
    assert all(abs(values.mean()) < 1e-9 * (1.0 + np.abs(values).max()) for values in known.values())
