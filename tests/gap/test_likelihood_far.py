"""Where a model is far from its log: gains of the model point the wrong way, and digits show what no row does."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.gap import diagnose
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.candidates import by_race
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.fit import refined, unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import legal, model_alone
from stickslip.gap.likelihood.settling import free_names, settled
from stickslip.gap.likelihood.sizes import sizes
from stickslip.logs import Log
from stickslip.logs.dirt import swinging_door

from tests.gap.root_tank import framed, logged, tank

SET_POINT = {"setpoint_filter", "setpoint_ramp", "setpoint_weight"}


def effect(name: str) -> Effect:
    return next(one for one in CATALOGUE if one.name == name)


def test_a_fit_far_from_the_truth_finds_it() -> None:
    # slopes with the gains of another controller say that a smaller factor is likelier
    true = effect("controller_gain").insert(tank(), "controller", factor=2.0)
    one = Hypothesis(replace(framed(tank(), logged(true, 5)), apart=True), effect("controller_gain"), "controller")
    found = refined(one.filtered({"factor": 1.5}), free_names(one))
    assert found.best.values["factor"] == pytest.approx(2.0, rel=0.02)


def test_first_rows_know_the_effect() -> None:
    true = effect("process_gain").insert(tank(), "tank", factor=1.4)
    frame = framed(tank(), logged(true, 6))
    rough = model_alone(replace(frame, apart=True))
    places = {"process_gain": "tank", "controller_gain": "controller", "sensor_lag": "sensor"}
    one = [Hypothesis(rough.hypothesis.frame, effect(name), place) for name, place in places.items()]
    first, *_ = by_race(settled(rough), rough, one)
    assert first.hypothesis.effect is one[0].effect
    assert first.values["factor"] == pytest.approx(1.4, rel=0.05)


def test_scans_are_read_off_the_log() -> None:
    true = effect("scan_time").insert(tank(False), "controller", period=12.0)
    frame = framed(tank(False), logged(true, 7))
    one = Hypothesis(frame, effect("scan_time"), "controller")
    periods = {size["period"] for size in sizes(model_alone(replace(frame, apart=True)), one)}
    assert min(abs(period - 12.0) for period in periods) < 0.02


@pytest.mark.parametrize("step", [0.0217, 0.02], ids=["rounded again", "a multiple of the log's digit"])
def test_a_coarse_sensor_is_named_by_its_digits(step: float) -> None:
    true = effect("quantisation").insert(tank(), "sensor", step=step)
    (cause,) = diagnose(tank(), logged(true, 8), limits=False).causes
    assert (cause.effect, cause.place) == ("quantisation", "sensor")
    assert cause.parameters["step"].value == pytest.approx(step, rel=0.01)


def test_a_log_that_rounds_is_no_coarse_sensor() -> None:
    log = logged(tank(), 8)
    rounded = {"PV": np.round(log["PV"] / 0.01) * 0.01}
    assert not diagnose(tank(), Log(log.t, {**{s: log[s] for s in log.names}, **rounded}), limits=False).gap


def test_another_gain_of_the_controller_is_no_coarse_sensor_where_the_log_rounds() -> None:
    # noise of any size gained a thousand nats, which the digit of the log was given as a step of the sensor
    log = logged(effect("controller_gain").insert(tank(), "controller", factor=1.8), 8)
    rounded = Log(log.t, {**{s: log[s] for s in log.names}, "PV": np.round(log["PV"] / 0.003) * 0.003})
    known = [effect(name) for name in ("quantisation", "controller_gain", "sensor_noise")]
    causes = diagnose(tank(sd=0.003), rounded, catalogue=known, limits=False).causes  # the load is 0.01
    assert "quantisation" not in [cause.effect for cause in causes]


def test_a_controller_behind_a_sensor_whose_step_is_stated_has_seen_what_the_log_has() -> None:
    # the step was taken for rounding of the log, and what the controller made of it left 8.7 standard deviations
    stepped = tank().with_params({"sensor.step": 0.001})
    log = logged(stepped, 8)
    left = checks(settled(model_alone(replace(framed(stepped, log), apart=True))).best)
    assert max(abs(size) for size in left.values()) < 6.0
    said = diagnose(stepped, log, catalogue=[effect("sensor_span")], limits=False).notes[0]
    assert "PV rounded to 0.001" in said, said  # and not to what the controller knows of it


def test_a_size_far_off_is_found_where_a_stated_step_of_the_sensor_makes_the_likelihood_rough() -> None:
    # slopes were those of single steps: from the first size, 0.75, no fit came below 0.72
    stepped = tank().with_params({"sensor.step": 0.001})
    log = logged(effect("controller_integral_time").insert(stepped, "controller", factor=0.35), 8)
    rough = model_alone(replace(framed(stepped, log), apart=True))
    one = Hypothesis(rough.best.hypothesis.frame, effect("controller_integral_time"), "controller")
    (found,) = by_race(settled(rough), rough, [one])
    assert found.values["factor"] == pytest.approx(0.35, rel=0.05)


@pytest.mark.usefixtures("without_hints")
def test_a_load_that_wants_to_be_far_slower_than_every_fit_lets_it_is_a_gap_of_no_name() -> None:
    # a process gain of 1.006 was named beside a load of 25 s, five times what is stated, where it is 100 s
    log, known = logged(tank(time=100.0), 8), [effect("sensor_bias"), effect("process_gain")]
    report = diagnose(tank(time=5.0), log, catalogue=known, limits=False)
    assert [cause.effect for cause in report.causes] == ["unknown"]
    assert "feed.correlation_time at its bound" in str(report)
    assert "Probability of this answer: 75 %." in str(report)


def test_what_lies_in_the_path_of_a_set_point_is_looked_for_only_where_it_moves() -> None:
    # a set point at rest shows nothing of it: by the start of a log a weight gained 319 nats, and moved no signal
    log = logged(tank(), 8)
    still = Log(log.t[:140], {s: log[s][:140] for s in log.names})  # its set point moves first at 771 s
    for one, shown in ((log, SET_POINT), (still, set())):
        null = unfitted(Hypothesis(framed(tank(), one)).filtered({}))
        names = {h.effect.name for h in legal(null, CATALOGUE) if h.effect is not None}
        assert names & SET_POINT == shown
        assert {"controller_filter", "controller_gain", "derivative_action"} <= names


def test_a_historian_that_compresses_is_named_by_its_lines() -> None:
    log = logged(tank(), 9)
    drawn = swinging_door(log, 0.012, ["PV"])["PV"]
    other = Log(log.t, {**{s: log[s] for s in log.names}, "PV": np.round(drawn, 4)})
    (cause,) = diagnose(tank(), other, limits=False).causes
    assert (cause.effect, cause.place) == ("compression", "historian")


def test_an_output_that_moves_at_every_row_scans_no_more_seldom_than_rows_come() -> None:
    # 254 slower scans cost a filter each, and a loop whose sensor rounds took over 5 minutes for them
    f = framed(tank(), logged(tank(), 8))
    null = unfitted(Hypothesis(f).filtered({}))
    periods = {size["period"] for size in sizes(null, Hypothesis(f, effect("scan_time"), "controller"))}
    assert periods and max(periods) <= 2.0 * f.record.log.dt
    held = framed(tank(), logged(tank(), 8, every=1.0))  # the scan is 2 s: every other row is as the one before
    null = unfitted(Hypothesis(held).filtered({}))
    periods = {size["period"] for size in sizes(null, Hypothesis(held, effect("scan_time"), "controller"))}
    assert {4.0, 6.0} <= periods
