"""Parameters that change along a record: what keeps an unknown effect from a known name."""

import numpy as np
import pytest
from stickslip.cases.models import site_flow
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import frame_of
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.checks import known_of
from stickslip.gap.likelihood.constancy import changes, stretches
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read

from tests.gap.outside_loops import KINDS, site_log

FEW = ("step_disturbance", "sine_disturbance", "sensor_drift", "sensor_noise", "process_gain", "second_lag")
CATALOGUE = [effect(name) for name in FEW]
KNOWN = {
    "none": [],
    "step": ["step_disturbance"],
    "sine": ["sine_disturbance"],
    "more noise": ["sensor_noise"],
}
UNSEEN = ("a gain that goes with the direction", "a noise that grows with the level")  # too small for free noise
LATE = ("a gain that switches", "a slow load")  # in less time these leave what a step or a drift would
ALIKE = ("a ramp of the load",)  # a drift of the sensor leaves a log like it


@pytest.mark.usefixtures("without_hints")
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in (*UNSEEN, *ALIKE)])
def test_what_no_catalogue_has_is_unknown_and_what_it_has_is_named(kind):
    log = site_log(kind, hours=2.0 if kind in LATE else 1.4)
    report = diagnose(site_flow(), log, catalogue=CATALOGUE, progress=False, limits=False)
    assert [cause.effect for cause in report.causes] == KNOWN.get(kind, ["unknown"])


@pytest.mark.usefixtures("without_hints")
@pytest.mark.parametrize("kind", UNSEEN)
def test_what_is_too_small_to_show_beside_noise_that_is_fitted_gets_no_name(kind):
    report = diagnose(site_flow(), site_log(kind), catalogue=CATALOGUE, progress=False, limits=False)
    assert {cause.effect for cause in report.causes} <= {"unknown"}


def test_what_parameters_do_already_is_no_change_of_theirs():
    # e in the span of the slopes: its part beside them is 0 (analytic)
    rng = np.random.default_rng(1)
    slopes = {"a": rng.normal(size=(900, 2)), "b": rng.normal(size=(900, 2))}
    e = 3.0 * slopes["a"] - 2.0 * slopes["b"]
    found = changes(slopes, {"level": rng.normal(size=900)} | stretches(900))
    assert len(found) == 14
    assert max(abs(float(np.sum(e * v))) for v in found.values()) < 1e-9


def test_figures_of_change_are_normal_where_nothing_changes():
    rng = np.random.default_rng(2)
    slopes = {"a": rng.normal(size=(400, 2)), "b": np.cumsum(rng.normal(size=(400, 2)), axis=0)}
    known = {"level": np.sin(np.arange(400) / 30.0)} | stretches(400)
    found = np.array([v.ravel() for v in changes(slopes, known).values()])
    many = found @ rng.normal(size=(800, 800))
    assert np.abs(many.mean(axis=1)).max() < 0.15  # standard error 0.035
    assert np.abs(many.std(axis=1) - 1.0).max() < 0.1  # standard error 0.025


def test_a_size_that_goes_with_a_level_is_seen():
    rng = np.random.default_rng(3)
    d, g = rng.normal(size=(900, 1)), np.sin(np.arange(900.0))
    found = changes({"a": d}, {"level": g})["a with level"]
    seen = float(np.sum(found * (rng.normal(size=(900, 1)) + 0.3 * d * g[:, None])))
    # expected 0.3 |d g| = 0.3 sqrt(900) in units of g's own size sqrt(1/2): 6.4, standard deviation 1
    assert seen == pytest.approx(0.3 * np.sqrt(900.0 / 2.0), abs=4.0)


def test_what_rows_are_known_by_has_no_mean():
    known = known_of(Hypothesis(frame_of(*read(site_flow(), site_log("none")))).filtered({}))
    assert all(abs(values.mean()) < 1e-9 * (1.0 + np.abs(values).max()) for values in known.values())
