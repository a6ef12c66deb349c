"""What a filter's fits find where it is hard: sizes of a deadband, slow scans, small offsets, limits, a logged stem.

Records are of the house's own loop as a site logs it; every expected size is the one put in (analytic).
"""

import numpy as np
import pytest
from stickslip.cases.models import level_cascade, site_flow
from stickslip.gap import calibrated, diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.bank import left_by_bank
from stickslip.gap.likelihood.framing import frame_of, when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.logged_stem import logged_stem
from stickslip.gap.records.model import read
from stickslip.gap.reporting.sizes import shrinkage_of_losses
from stickslip.logs import Log

from benchmarks.gap.generator import record
from tests.gap.outside_loops import KINDS, site_log


def known(*names):
    return [effect(name) for name in names]


def named(report):
    return [cause.effect for cause in report.causes]


def test_the_width_of_a_deadband_is_not_stretched_by_what_is_unsure_between_rows(site_record):
    log = site_record("deadband", "valve", width=2.0)
    cause = diagnose(site_flow(), log, catalogue=known("deadband")).causes[0]
    assert cause.parameters["width"].value == pytest.approx(2.0, rel=0.06)


@pytest.mark.parametrize("period", [6.0, 7.0])
def test_a_slow_scan_is_named_with_its_period(site_record, period):
    log = site_record("scan_time", "controller", period=period, offset=0.0, present=1.0)
    report = diagnose(site_flow(), log, catalogue=known("scan_time", "sensor_noise", "controller_integral_time"))
    assert named(report) == ["scan_time"]
    assert report.causes[0].parameters["period"].value == period


def test_what_leaves_the_same_log_as_a_bias_is_named_with_it_however_small(site_record):
    log = site_record("valve_leak", "valve", flow=2.5, hours=2.0)
    cause = diagnose(site_flow(), log, catalogue=known("valve_leak", "sensor_bias", "sensor_noise")).causes[0]
    assert {cause.effect, *cause.ambiguous_with} == {"valve_leak", "sensor_bias"}


def test_an_output_that_stands_at_a_limit_is_sure(site_record):
    # the likelihood of a rounded value that is sure is 1/step, which is 0.5 ln(step^2/(2 pi)) in the filter's loss
    log = site_record("controller_limits", "controller", low=0.0, high=58.0)
    f = when_switched(frame_of(*read(site_flow(), log)))
    one = Hypothesis(f, effect("controller_limits"), "controller").filtered({"low": 0.0, "high": 58.0})
    standing = np.isnan(one.e[:, 1]) & ~np.isnan(one.e[:, 0])
    assert standing.sum() > 10
    assert np.abs(log["OP"][standing] - 0.58).max() < 0.0011
    of_PV = 0.5 * (one.e[:, 0] ** 2 + np.log(one.S[:, 0]))
    assert one.losses[standing] == pytest.approx(of_PV[standing] + 0.5 * np.log(1e-6 / (2.0 * np.pi)), abs=1e-3)
    report = diagnose(site_flow(), log, catalogue=known("controller_limits", "sensor_noise", "controller_gain"))
    assert named(report) == ["controller_limits"]
    assert report.causes[0].parameters["high"].value == pytest.approx(58.0, abs=0.1)


def test_a_limit_that_op_meets_between_two_rows_only_is_found():
    # the limit put in is 67.27 %, the highest logged OP 64.8 %: the record's own numbers (analytic)
    made = record("site", ["controller_limits"], "typical", 8604)
    true = made.effects["controller_limits"]["high"]
    assert 100.0 * made.signals["OP"].max() < true - 2.0
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    report = diagnose(site_flow(), log, catalogue=known("controller_limits", "sensor_noise", "controller_gain"))
    assert named(report) == ["controller_limits"]
    high = report.causes[0].parameters["high"]
    assert high.value == pytest.approx(true, abs=1.5)
    assert high.low < high.value < high.high  # no row says which it is


def test_a_log_that_begins_as_if_the_controller_were_at_a_limit_has_a_filter(site_record):
    log = site_record()
    OP = log["OP"].copy()
    OP[0] = -0.4 * (log["SP"][0] - log["PV"][0]) - 0.5
    assert frame_of(*read(site_flow(), Log(log.t, {"SP": log["SP"], "PV": log["PV"], "OP": OP}))) is not None


def test_a_logged_stem_says_on_which_side_of_it_the_gap_lies(site_record):
    behind = site_record("valve_gain", "valve", factor=1.25, stem=True)
    stem = logged_stem(*read(site_flow(), behind))
    assert stem.follows
    assert stem.place == "valve"
    few = known("valve_gain", "positioner_lag", "process_gain", "second_lag", "deadband", "sensor_noise")
    report = diagnose(site_flow(), behind, catalogue=few)
    assert named(report) == ["valve_gain"]
    assert "follows" in str(report)
    before = site_record("positioner_lag", "valve", tau=2.0, stem=True)
    assert not logged_stem(*read(site_flow(), before)).follows
    report = diagnose(site_flow(), before, catalogue=few)  # without the stem it cannot be told from a second lag
    assert named(report) == ["positioner_lag"]
    assert report.causes[0].ambiguous_with == ()


@pytest.mark.usefixtures("without_hints")
def test_a_stem_that_does_not_follow_is_a_gap_though_nothing_else_shows(site_record):
    log = site_record(stem=True)
    MV = log["MV"].copy()
    MV[500:] += 0.004
    log = Log(log.t, {**{s: log[s] for s in ("SP", "PV", "OP")}, "MV": MV})
    report = diagnose(site_flow(), log, catalogue=known("deadband", "positioner_lag", "sensor_noise"))
    assert named(report) == ["unknown"]
    assert report.where.confidence_set == ("valve",)


def test_a_calibration_counts_answers_of_the_filter_and_a_diagnosis_states_them(site_record):
    log, few = site_record("second_lag", "process", tau=2.0), known("second_lag", "controller_gain")
    found = calibrated(site_flow(), log, catalogue=few, runs=1, progress=False)
    assert found.confusion["none"] == {"none": 5}
    assert set(found.confusion) == {"none", "second_lag", "controller_gain"}
    assert set(found.hit_rates.own) <= {"digits", "white", "pair", "unknown"}
    report = diagnose(site_flow(), log, catalogue=few)
    assert report.causes[0].probability == found.hit_rates.probability(report.evidence)
    assert "in 7 runs of this model" in report.notes[-1]


def test_a_slow_stem_under_a_noisy_output_is_named_in_a_cascade():
    # its likelihood is a peak between two sizes of the grid, and its filter knows it by mean and variance only
    made = record("cascade", ["valve_rate_limit"], seed=7701, hours=0.75)
    log = Log(made.signals["time"], {s: v for s, v in made.signals.items() if s not in ("time", "MV")})
    report = diagnose(level_cascade(), log, catalogue=known("valve_rate_limit", "positioner_lag", "sensor_noise"))
    assert named(report) == ["valve_rate_limit"]
    true = made.effects["valve_rate_limit"]["rate"]
    assert report.causes[0].parameters["rate"].value == pytest.approx(true, rel=0.03)


def test_a_bank_of_stems_outlives_rows_that_exclude_every_stem():
    # a sensor that freezes for half a minute at a time: where it moves again, rows are hundreds of deviations off
    made = record("site", severity="gross", seed=7800, outside="frozen_sensor")
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    one = Hypothesis(when_switched(frame_of(*read(site_flow(), log))), effect("deadband"), "valve")
    found = [left_by_bank(one, {**one.frame.stated, "width": width}, None, 4).nll for width in (0.1, 1.0, 10.0)]
    assert np.isfinite(found).all()


def test_a_limit_at_the_highest_output_of_a_record_without_a_gap_is_none():
    # expected: none; one row at which OP stands as high as it ever does gained 7.5 nats by chance
    made = record("cascade", seed=1009, family="report_4")
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP_L", "L", "SP", "PV", "OP")})
    limits = known("controller_limits", "sensor_noise")
    assert not diagnose(level_cascade(), log, catalogue=limits, limits=False).gap


@pytest.mark.parametrize("name", ["valve_gain", "process_gain"])
def test_a_gain_is_as_unsure_as_the_tolerance_of_another_gain_beside_it(name, monkeypatch):
    # the product of both gains shows alone: 0.8 of 3, stated as 2.85 to 3.15 (a loop in plain Python)
    monkeypatch.setitem(KINDS, "a gain of 0.8", lambda t, rng: {"K": 0.8 * 3.0})
    report = diagnose(site_flow(), site_log("a gain of 0.8"), catalogue=known(name))
    size = report.causes[0].parameters["factor"]
    assert size.low < 0.8 < size.high
    assert 0.04 < size.high - size.low < 0.12


def test_where_no_gap_is_left_to_shrink_the_report_says_so():
    # the model alone, fitted again, leaves as little as innovations of unit size
    e = np.ones((120, 2))
    none = shrinkage_of_losses(np.full(120, 1.0), np.full(120, 1.0), e, 60)
    assert none.fraction == 0.0
    assert "too small beside the noise to tell" in str(none)
