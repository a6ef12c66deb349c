"""What a record tells of its effect, by physics alone: nothing where the model's tolerances do the same."""

import pytest

from benchmarks.gap.generator import record
from benchmarks.gap.visible import TIE, TRACE, told, told_apart, traced, visible


def test_a_span_within_the_tolerance_of_the_hold_up_leaves_no_trace():
    # analytic: a level's span s and hold-up T do the same as T/s; T is known within 10 %
    assert told(record("level", ["sensor_span"], seed=3, hours=0.7, given={"sensor_span": {"factor": 0.99}})) < 0.1
    assert told(record("level", ["sensor_span"], seed=3, hours=0.7, given={"sensor_span": {"factor": 0.7}})) > TRACE


def test_a_lag_of_the_sensor_leaves_a_trace_and_is_one_of_the_process():
    made = record("level", ["sensor_lag"], seed=3, hours=0.7, given={"sensor_lag": {"tau": 30.0}})
    assert told(made) > TRACE
    assert told_apart(made, "second_lag") < 0.1  # analytic: the same place in the loop
    assert told_apart(made, "controller_gain") > TIE


@pytest.mark.parametrize("other", ["sensor_drift", "step_disturbance"])
def test_on_a_level_a_leak_is_a_drift_and_a_step_from_the_start(other):
    # analytic: an integral makes a ramp of a constant
    made = record("level", ["valve_leak"], seed=3, hours=0.7)
    assert told_apart(made, other) < 0.5 < TRACE < told(made)


def test_what_shows_in_digits_or_noise_is_not_left_out():
    assert told(record("site", ["sensor_noise"], hours=0.5)) == float("inf")


def test_a_record_is_left_out_only_where_the_oracle_says_that_it_tells_nothing():
    assert visible({"visible": 0.4, "told": None}) and visible({"visible": 0.4, "told": 7.0})
    assert not visible({"visible": 0.4, "told": 2.0}) and not visible({"visible": 0.04, "told": None})


def test_a_set_is_right_if_the_oracle_cannot_tell_its_names_apart_either():
    made = record("level", ["sensor_lag"], seed=3, hours=0.3)
    assert traced(made, {"cause": False, "sets": [["second_lag", "sensor_lag"]]})["told_apart"] is True
    assert traced(made, {"cause": False, "sets": [["controller_gain"]]})["told_apart"] is None  # the truth is missing
    assert traced(made, {"cause": True, "sets": [["sensor_lag"]]})["told_apart"] is None
