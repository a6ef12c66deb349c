"""Two effects of which one is a sensor of few levels, or a stem that is the smaller of the two."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.gap.generator import record

DIGITS = [effect(name) for name in ("quantisation", "step_disturbance", "sensor_bias", "process_gain")]
STEM = [effect(name) for name in ("deadband", "process_gain", "valve_gain", "sensor_span", "dead_time")]


def test_a_step_beside_a_sensor_of_few_levels_is_named_too(with_effects):
    step = ("step_disturbance", "feed", {"amplitude": 0.015, "time": 900.0})
    log = with_effects(3, ("quantisation", "sensor", {"step": 0.02}), step)
    causes = {c.effect: c.parameters for c in diagnose(ideal_flow(), log, catalogue=DIGITS, progress=False).causes}
    assert set(causes) == {"quantisation", "step_disturbance"}
    assert causes["quantisation"]["step"].value == pytest.approx(0.02, rel=1e-3)
    assert causes["step_disturbance"]["amplitude"].value == pytest.approx(0.015, rel=0.1)
    assert causes["step_disturbance"]["time"].value == pytest.approx(900.0, abs=20.0)


def test_a_sensor_of_few_levels_alone_is_named_alone(with_effects):
    log = with_effects(3, ("quantisation", "sensor", {"step": 0.02}))
    (cause,) = diagnose(ideal_flow(), log, catalogue=DIGITS, progress=False).causes
    assert cause.effect == "quantisation"


def test_a_sensor_of_very_few_levels_in_the_record_of_another_program_is_named_alone():
    # expected: nothing beside; that program meets the levels at other instants, which a scan of 0.2 s fits by 550 nats
    made = record("ideal", ("quantisation",), "gross", 7910)
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    scans = [effect("quantisation"), effect("scan_time")]
    (cause,) = diagnose(ideal_flow(), log, catalogue=scans, progress=False).causes
    assert cause.effect == "quantisation"


def test_beside_more_noise_the_class_of_the_other_is_listed(with_effects):
    # analytic: gain of the valve, of the process and span of the sensor leave the same PV and OP
    catalogue = [effect(name) for name in ("sensor_noise", "sensor_span", "process_gain", "valve_gain", "dead_time")]
    span = ("sensor_span", "sensor", {"factor": 1.2})
    log = with_effects(5, span, ("sensor_noise", "sensor", {"factor": 3.0}))
    first, second = diagnose(ideal_flow(), log, catalogue=catalogue, limits=False, progress=False).causes
    assert {first.effect, *first.ambiguous_with} == {"sensor_span", "process_gain", "valve_gain"}
    assert second.effect == "sensor_noise" and not second.ambiguous_with


def test_a_stem_that_is_the_smaller_of_two_is_found_and_the_class_of_the_other(with_effects):
    values = {"deadband": {"width": 0.6}, "process_gain": {"factor": 1.2}}
    log = with_effects(5, ("process_gain", "process", values["process_gain"]),
                 ("deadband", "valve", values["deadband"]))  # fmt: skip
    causes = diagnose(ideal_flow(), log, catalogue=STEM, progress=False).causes
    both = {cause.effect: cause for cause in causes}
    assert both["deadband"].parameters["width"].value == pytest.approx(0.6, rel=0.02)
    (other,) = (cause for cause in causes if cause.effect != "deadband")
    assert {other.effect, *other.ambiguous_with} == {"process_gain", "valve_gain", "sensor_span"}
    assert other.parameters["factor"].value == pytest.approx(1.2, rel=0.005)
