"""Diagnoses where loads are not measured: records of the house's own loop as a site logs it, sizes known (analytic)."""

import numpy as np
import pytest
from stickslip.cases.models import level_loop, second_order_flow, site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

LEVEL = {"loop": level_loop, "middle": 0.5, "reach": 0.1, "digit": 0.0005}


def known(*names):
    return [effect(name) for name in names]


def test_no_gap_is_said_with_what_could_have_hidden(site_record):
    report = diagnose(site_flow(), site_record(), catalogue=known("second_lag", "sensor_bias", "sensor_noise"))
    assert not report.gap
    assert report.to_dict()["causes"] == []
    assert "Possible all the same" in str(report)
    assert "sensor_bias at sensor" in str(report)


def test_a_lag_is_named_with_all_that_leave_the_same_log(site_record):
    log = site_record("second_lag", "process", tau=2.0)
    report = diagnose(site_flow(), log, catalogue=known("second_lag", "sensor_lag", "dead_time", "sensor_noise"))
    assert {report.causes[0].effect, *report.causes[0].ambiguous_with} == {"second_lag", "sensor_lag"}
    assert report.causes[0].parameters["tau"].low < 2.0 < report.causes[0].parameters["tau"].high
    assert set(report.where.confidence_set) == {"process", "sensor"}
    assert report.shrinkage.fraction > 0.9


def test_a_noisy_sensor_is_named(site_record):
    log = site_record("sensor_noise", "sensor", factor=2.0)
    cause = diagnose(site_flow(), log, catalogue=known("sensor_noise", "second_lag", "sensor_bias")).causes[0]
    assert cause.effect == "sensor_noise"
    assert cause.parameters["factor"].value == pytest.approx(2.0, rel=0.05)


@pytest.mark.usefixtures("without_hints")
def test_a_coarse_sensor_is_told_from_a_coarse_log(site_record):
    coarse = site_record("quantisation", "sensor", step=0.02)
    cause = diagnose(site_flow(), coarse, catalogue=known("quantisation", "sensor_noise")).causes[0]
    assert cause.effect == "quantisation"
    assert cause.parameters["step"].value == pytest.approx(0.02, rel=0.01)
    without = diagnose(site_flow(), coarse, catalogue=known("sensor_noise"))  # leaves innovations as noise does
    assert [cause.effect for cause in without.causes] == ["unknown"]
    plain = site_record()  # the controller has seen what this log leaves out
    rounded = Log(plain.t, {**{s: plain[s] for s in ("SP", "OP")}, "PV": np.round(plain["PV"] / 0.02) * 0.02})
    assert "quantisation" not in [
        cause.effect for cause in diagnose(site_flow(), rounded, catalogue=known("quantisation", "sensor_noise")).causes
    ]


def test_a_compressing_historian_is_named(site_record):
    log = effect("compression").on_log(site_record(), deviation=0.02)
    log = Log(log.t, {**{s: log[s] for s in ("SP", "OP")}, "PV": np.round(log["PV"] / 0.0015) * 0.0015})
    report = diagnose(site_flow(), log, catalogue=known("compression", "sensor_noise", "controller_filter"))
    assert [cause.effect for cause in report.causes] == ["compression"]


def test_another_gain_of_the_controller_is_named_though_switches_hide_it(site_record):
    log = site_record("controller_gain", "controller", factor=0.84)
    report = diagnose(site_flow(), log, catalogue=known("controller_gain", "controller_filter", "sensor_noise"))
    assert report.causes[0].effect == "controller_gain"
    assert report.causes[0].parameters["factor"].value == pytest.approx(0.84, rel=0.005)


def test_stiction_is_told_from_a_deadband(site_record):
    log = site_record("stiction", "valve", S=5.0, J=2.5)
    cause = diagnose(site_flow(), log, catalogue=known("stiction", "deadband")).causes[0]
    assert cause.effect == "stiction"
    assert cause.parameters["S"].value == pytest.approx(5.0, rel=0.1)
    assert cause.parameters["J"].value == pytest.approx(2.5, rel=0.3)


@pytest.mark.usefixtures("without_hints")
def test_what_the_catalogue_lacks_is_unknown(site_record):
    log = site_record("controller_filter", "controller", tau=2.0)
    report = diagnose(site_flow(), log, catalogue=known("second_lag", "controller_gain", "sensor_noise"))
    assert [cause.effect for cause in report.causes] == ["unknown"]
    assert report.where.confidence_set == ("controller",)


def test_a_lag_in_a_loop_of_second_order_with_dead_time_is_named(site_record):
    log = site_record("sensor_lag", "sensor", loop=second_order_flow, tau=4.0)
    catalogue = known("second_lag", "sensor_lag", "dead_time", "controller_filter", "sensor_noise")
    report = diagnose(second_order_flow(), log, catalogue=catalogue)
    assert {report.causes[0].effect, *report.causes[0].ambiguous_with} == {"second_lag", "sensor_lag"}
    assert report.causes[0].parameters["tau"].value == pytest.approx(4.0, rel=0.1)


def test_a_small_sine_into_a_level_is_named_and_nothing_where_there_is_none(site_record):
    catalogue = known("sine_disturbance", "sensor_drift", "controller_gain", "sensor_noise")
    log = site_record("sine_disturbance", "feed", **LEVEL, amplitude=0.012, period=500.0, phase=0.3, hours=2.0)
    cause = diagnose(level_loop(), log, catalogue=catalogue).causes[0]
    assert cause.effect == "sine_disturbance"
    assert cause.parameters["amplitude"].value == pytest.approx(0.012, rel=0.3)
    assert not diagnose(level_loop(), site_record(**LEVEL, hours=2.0), catalogue=catalogue).gap


def test_a_coarse_sensor_of_a_level_is_named(site_record):
    log = site_record("quantisation", "sensor", **LEVEL, step=0.0031)
    report = diagnose(level_loop(), log, catalogue=known("quantisation", "sensor_noise"))
    assert [cause.effect for cause in report.causes] == ["quantisation"]
