"""What is far from the model is found as what is near it: where a search begins; sizes are those put in (analytic)."""

import math

import pytest

from cases.models import site_flow
from gap import diagnose
from gap.effects import effect
from gap.filters.diagnosing import filtering_of, outcome
from gap.records.model import read


def known(*names):
    return [effect(name) for name in names]


def test_a_valve_that_stops_short_for_a_quarter_of_the_time_is_named(site_record):
    # OP winds up while the stem stands at its stop: no row says where that is but those at which flow stops following
    log = site_record("valve_saturation", "valve", high=52.0)
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
    log = site_record("valve_saturation", "valve", high=52.0)
    f = filtering_of(*read(site_flow(), log))
    found = outcome(f, known("valve_saturation", "valve_gain", "stiction", "deadband"), 0, False)
    assert found.found[0].best.explanation.effect.name == "valve_saturation"
    assert math.isfinite(found.found[0].sd["high"])
