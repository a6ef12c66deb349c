"""What a report says beside the name: what would have shown, what cannot be told apart, the swap, the next tag."""

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.swapping import swapped

NAMES = ("valve_gain", "process_gain", "sensor_span", "dead_time", "second_lag", "controller_gain", "sensor_bias")
FEW = [effect(name) for name in NAMES]


def test_an_effect_shows_from_the_size_on_that_is_said(recorded):
    few = [effect("process_gain")]
    (least,) = diagnose(ideal_flow(), recorded(seed=5), catalogue=few, progress=False).seen
    assert least.effect == "process_gain" and 1.0 < least.size < 1.02
    for times, gap in ((2.0, True), (0.3, False)):
        log = recorded("process_gain", "process", seed=5, factor=1.0 + times * (least.size - 1.0))
        assert diagnose(ideal_flow(), log, catalogue=few, progress=False).gap is gap


def test_the_words_of_a_record_without_a_gap_say_what_would_have_shown(recorded):
    report = diagnose(ideal_flow(), recorded(seed=5), catalogue=FEW, progress=False)
    assert "would have shown" in str(report) and {one.effect for one in report.seen} == set(NAMES)
    short = diagnose(ideal_flow(), recorded(seed=5), catalogue=FEW, limits=False, progress=False)
    assert not short.seen and not short.gap


def test_the_tag_that_tells_gains_apart_is_named(recorded):
    log = recorded("valve_gain", "valve", factor=0.93)
    words = str(diagnose(ideal_flow(), log, catalogue=FEW, progress=False))
    assert "A log of F would separate them" in words


@pytest.mark.parametrize(("name", "place", "right", "wrong"), [
    ("process_gain", "process", "process", "controller"), ("controller_gain", "controller", "controller", "valve"),
])  # fmt: skip
def test_the_swap_of_the_right_segment_takes_the_gap_away(recorded, name, place, right, wrong):
    frame = held_against(ideal_flow(), recorded(name, place, factor=1.2))
    assert swapped(frame, right).share > 0.95
    assert swapped(frame, wrong).share < 0.5
    assert np.isfinite(swapped(frame, right).noise)


def test_a_step_near_the_end_is_found_though_most_rows_are_at_the_floor(recorded):
    log = recorded("step_disturbance", "feed", seed=9, amplitude=0.016, time=1560.0)
    report = diagnose(ideal_flow(), log, catalogue=[*FEW, effect("step_disturbance")], progress=False)
    (cause,) = report.causes
    assert cause.effect == "step_disturbance"
    assert cause.parameters["time"].value == pytest.approx(1560.0, abs=2.0)
    assert cause.parameters["amplitude"].value == pytest.approx(0.016, rel=0.06)


@pytest.mark.parametrize(("period", "present"), [(1.8, 0.0), (0.4, 1.0)])
def test_a_scan_that_meets_a_row_now_and_then_is_read_off(recorded, period, present):
    log = recorded("scan_time", "controller", seed=9, period=period, present=present)
    report = diagnose(ideal_flow(), log, catalogue=[*FEW, effect("scan_time")], progress=False)
    assert [cause.effect for cause in report.causes] == ["scan_time"]
    assert report.causes[0].parameters["period"].value == pytest.approx(period, rel=1e-3)
