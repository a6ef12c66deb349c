"""Two effects of which one is a sensor of few levels, or a stem that is the smaller of the two."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.alternatives import alternatives
from stickslip.gap.explanations.beside_digits import beside_digits
from stickslip.gap.explanations.candidates import candidates, ranked
from stickslip.gap.explanations.pairs import paired
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
    problem = prepared(ideal_flow(), log)
    (first,) = [f for f in ranked(candidates(problem, problem.quiet, DIGITS), False) if f.effect.name == "quantisation"]
    assert beside_digits(problem, first, DIGITS, 1, False) is None


def test_a_sensor_of_very_few_levels_in_the_record_of_another_program_is_named_alone():
    # expected: nothing beside; that program meets the levels at other instants, which a scan of 0.2 s fits by 550 nats
    made = record("ideal", ("quantisation",), "gross", 7910)
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    problem = prepared(ideal_flow(), log)
    scans = [effect("quantisation"), effect("scan_time")]
    (first,) = [f for f in ranked(candidates(problem, problem.quiet, scans), False) if f.effect.name == "quantisation"]
    assert beside_digits(problem, first, scans, 1, False) is None


def test_beside_more_noise_the_class_of_the_other_is_listed(with_effects):
    # analytic: gain of the valve, of the process and span of the sensor leave the same PV and OP
    catalogue = [effect(name) for name in ("sensor_noise", "sensor_span", "process_gain", "valve_gain", "dead_time")]
    span = ("sensor_span", "sensor", {"factor": 1.2})
    log = with_effects(5, span, ("sensor_noise", "sensor", {"factor": 2.0}))
    first, second = diagnose(ideal_flow(), log, catalogue=catalogue, limits=False, progress=False).causes
    assert {first.effect, *first.ambiguous_with} == {"sensor_span", "process_gain", "valve_gain"}
    assert second.effect == "sensor_noise" and not second.ambiguous_with


def test_a_stem_that_is_the_smaller_of_two_is_found_and_the_class_of_the_other(with_effects):
    values = {"deadband": {"width": 0.6}, "process_gain": {"factor": 1.2}}
    log = with_effects(5, ("process_gain", "process", values["process_gain"]),
                 ("deadband", "valve", values["deadband"]))  # fmt: skip
    problem = prepared(ideal_flow(), log)
    gains = [one for one in STEM if one.name != "deadband"]
    fits = ranked(candidates(problem, problem.quiet, gains), False)  # as if no stem had come near by itself
    pair = paired(problem, fits, STEM, False)
    both = {fit.effect.name: fit for fit in (pair.first, pair.second)}
    assert both["deadband"].values["width"] == pytest.approx(0.6, rel=0.02)
    same = alternatives(problem, pair, STEM)[0 if pair.second is both["deadband"] else 1]
    assert {fit.effect.name for fit in same} == {"process_gain", "valve_gain", "sensor_span"}
    assert same[0].values["factor"] == pytest.approx(1.2, rel=0.005)
