"""What is far from the model is found as what is near it: where a search begins; sizes are those put in (analytic)."""

import math

import numpy as np
import pytest
from scipy.stats import norm
from stickslip.cases.models import site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.diagnosing import outcome
from stickslip.gap.likelihood.explained import TIE
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.records.model import read
from stickslip.logs import Log

from benchmarks.gap.generator import record


def known(*names):
    return [effect(name) for name in names]


def test_a_valve_that_stops_short_for_a_quarter_of_the_time_is_named(site_record):
    # OP winds up while the stem stands at its stop: no row says where that is but those at which flow stops following
    log = site_record("valve_saturation", "valve", high=52.0, hours=2.0)
    assert (log["OP"] > 0.52).mean() > 0.2
    few = known("valve_saturation", "valve_gain", "valve_rate_limit", "sensor_noise")
    (cause,) = diagnose(site_flow(), log, catalogue=few).causes
    assert cause.effect == "valve_saturation"
    assert cause.parameters["high"].value == pytest.approx(52.0, abs=0.5)


def test_a_sine_of_five_rows_is_named(site_record):
    # a filter knows what a load does between two rows, so its period may be as short as the log can show
    log = site_record("sine_disturbance", "feed", amplitude=0.03, period=23.0, phase=0.2)
    few = known("sine_disturbance", "sensor_noise", "positioner_lag")
    (cause,) = diagnose(site_flow(), log, catalogue=few).causes
    assert cause.effect == "sine_disturbance"
    assert cause.parameters["period"].value == pytest.approx(23.0, rel=0.002)


def test_stems_that_must_not_stick_do_not_keep_fits_from_being_made(site_record):
    # a stop far from the model leaves a bank of stems that do not stick far worse than a single filter: what sticking
    # stems gain over those is no nll that anything could come to
    log = site_record("valve_saturation", "valve", high=52.0, hours=2.0)
    found = outcome(frame_of(*read(site_flow(), log)), known("valve_saturation", "valve_gain", "stiction", "deadband"))
    assert found.fits[0].hypothesis.effect.name == "valve_saturation"
    assert math.isfinite(found.fits[0].sd["high"])


def test_a_load_that_could_lie_elsewhere_is_named():
    # a slug of 12 minutes acts as slowly at the feed as in the sensor
    made = record("site", ["slug"], seed=8506)
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    report = diagnose(site_flow(), log, catalogue=known("slug", "sine_disturbance", "sensor_noise", "valve_leak"))
    assert [cause.effect for cause in report.causes] == ["slug"]


def test_a_tie_leaves_out_a_right_explanation_in_one_of_100_records_at_most():
    # analytic: the log likelihood ratio of right to wrong is N(d, 2 d) if the record tells d nats of the two on average
    told = np.geomspace(0.01, 100.0, 2001)
    assert norm.cdf(-(TIE + told) / np.sqrt(2.0 * told)).max() < 1.0 / 100.0
