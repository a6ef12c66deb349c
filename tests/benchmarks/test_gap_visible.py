"""What a record tells of its effect, by physics alone: nothing where the model's tolerances do the same."""

from functools import cache, partial

import pytest

from benchmarks.gap import visible as oracle
from benchmarks.gap import whitened
from benchmarks.gap.generator import record
from benchmarks.gap.loop_numbers import KARNOPP
from benchmarks.gap.unseen_stem import by_tolerances, of_stem, sizes
from benchmarks.gap.visible import TIE, TRACE, alike_here, nats_apart, nats_shown, traced, visible


@pytest.fixture(autouse=True, scope="module")
def two_days_of_noise():
    """Whiten by half the noise of the benchmark, which moves the nats of no record across a bound here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(whitened, "HOURS", 50)
        for kept in (whitened.noise_of, whitened.whitening):
            kept.cache_clear()
        yield
    for kept in (whitened.noise_of, whitened.whitening):
        kept.cache_clear()


def test_a_span_within_the_tolerance_of_the_hold_up_leaves_no_trace():
    # analytic: a level's span s and hold-up T do the same as T/s; T is known within 10 %
    assert (
        nats_shown(record("level", ["sensor_span"], seed=3, hours=0.7, given={"sensor_span": {"factor": 0.99}})) < 0.1
    )
    assert (
        nats_shown(record("level", ["sensor_span"], seed=3, hours=0.7, given={"sensor_span": {"factor": 0.7}})) > TRACE
    )


def test_a_lag_of_the_sensor_leaves_a_trace_and_is_one_of_the_process():
    made = record("level", ["sensor_lag"], seed=3, hours=0.7, given={"sensor_lag": {"tau": 30.0}})
    assert nats_shown(made) > TRACE
    assert nats_apart(made, "second_lag") < 0.1  # analytic: the same place in the loop
    assert nats_apart(made, "controller_gain") > TIE


@pytest.mark.parametrize("other", ["sensor_drift", "step_disturbance"])
def test_on_a_level_a_leak_is_a_drift_and_a_step_from_the_start(other):
    # analytic: an integral makes a ramp of a constant
    made = record("level", ["valve_leak"], seed=3, hours=0.7)
    assert nats_apart(made, other) < 0.5 < TRACE < nats_shown(made)


def test_what_shows_in_digits_or_noise_is_not_left_out():
    assert nats_shown(record("site", ["sensor_noise"], hours=0.5)) == float("inf")


def test_a_record_is_left_out_only_where_the_oracle_says_that_it_tells_nothing():
    assert visible({"visible": 0.4, "told": None}) and visible({"visible": 0.4, "told": 7.0})
    assert not visible({"visible": 0.4, "told": 2.0}) and not visible({"visible": 0.04, "told": None})


def test_a_set_is_right_if_the_oracle_cannot_tell_its_names_apart_either():
    made = record("level", ["sensor_lag"], seed=3, hours=0.3)
    assert traced(made, {"cause": False, "sets": [["second_lag", "sensor_lag"]]})["told_apart"] is True
    assert traced(made, {"cause": False, "sets": [["controller_gain"]]})["told_apart"] is None  # the truth is missing
    assert traced(made, {"cause": True, "sets": [["sensor_lag"]]})["told_apart"] is None


def test_a_limit_that_only_a_little_noise_reaches_leaves_no_trace():
    # 5 % of travel below what the level reaches once; and one that it meets all the time
    assert nats_shown(record("level", ["valve_saturation"], seed=7700, hours=1.0)) < TRACE
    low = {"valve_saturation": {"low": 0.0, "high": 50.0}}
    assert nats_shown(record("level", ["valve_saturation"], seed=7700, hours=1.0, given=low)) > 10.0 * TRACE


def test_a_stem_that_nobody_sees_is_told_by_its_likelihood():
    # a play of 0.1 % is nothing beside OP steps of 0.8 % from scan to scan
    small = record("level", ["deadband"], seed=7701, hours=1.0, given={"deadband": {"width": 0.1}})
    assert nats_shown(small) < 1.0
    own = {"stiction": {"S": 3.0, "J": 1.3, "law": KARNOPP}}
    wide = record("second_order", ["stiction"], seed=7701, hours=1.0, given=own)
    assert nats_shown(wide) > 2.0 * TRACE
    # a log without a stem speaks against one: Neyman and Pearson's ratio has the other sign
    none = record("second_order", ["deadband"], seed=7701, hours=1.0, given={"deadband": {"width": 1e-9}})
    S, J = sizes(wide)
    assert of_stem(none, S, J) < 0.0 < of_stem(wide, S, J)


def test_parameters_within_tolerance_gain_on_a_log_what_chi_squared_says():
    # analytic: without an effect twice the nats are chi-squared of as many degrees as there are parameters (two here)
    gained = [by_tolerances(record("second_order", ["deadband"], seed=s, hours=0.5,
                                   given={"deadband": {"width": 1e-9}})) for s in (1, 2)]  # fmt: skip
    assert min(gained) >= 0.0 and max(gained) < 7.0


def test_a_dead_time_between_two_steps_of_the_integration_lies_between_both():
    near = record("site", ["dead_time"], seed=7700, hours=0.3, given={"dead_time": {"theta": 0.73}})
    assert nats_apart(near, "dead_time") < 0.3  # analytic: it is what it is


def test_a_class_is_of_the_record_not_of_the_answer(monkeypatch):
    made = record("cascade", ["dead_time"], seed=7700, hours=0.5)  # 0.7 s in a loop that is logged every 5 s
    apart, nats = cache(partial(nats_apart, made)), nats_shown(made)  # two answers are traced, and the class is asked
    monkeypatch.setattr(oracle, "nats_apart", lambda _, other: apart(other))
    monkeypatch.setattr(oracle, "nats_shown", lambda _: nats)
    assert alike_here(made, ("dead_time", "positioner_lag", "controller_gain")) == ("dead_time", "positioner_lag")
    row = {"cause": False, "place": False, "places": ["process", "valve"], "sets": [["dead_time", "positioner_lag"]]}
    found = traced(made, row)
    assert found["told_apart"] is True and found["told_place"] is True
    assert traced(made, row | {"places": ["process", "controller"]})["told_place"] is False
