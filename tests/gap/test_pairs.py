"""Two effects at once in one segment, where no single one shows the way to the other."""

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.candidates import candidates, ranked
from stickslip.gap.explanations.proposals import proposed
from stickslip.gap.fits.search import near_neutral
from stickslip.gap.fits.together import together
from stickslip.gap.records.offsets import held
from stickslip.logs import Log

from benchmarks.gap.generator import record

NAMES = ("dead_time", "second_lag", "process_gain", "controller_gain", "sensor_bias", "process_time_constant")
FEW = [effect(name) for name in NAMES]


@pytest.fixture(scope="module")
def log(recorded, logged):
    """A record of a process with a dead time and a second lag, of which the model has neither."""
    model = effect("second_lag").insert(
        effect("dead_time").insert(ideal_flow(rest=1.5), "process", theta=1.3), "process", tau=2.2
    )
    return logged(model, recorded(seed=3), 3)


def test_two_effects_of_one_segment_are_both_named(log):
    report = diagnose(ideal_flow(), log, catalogue=FEW, progress=False)
    sizes = {cause.effect: cause.parameters for cause in report.causes}
    assert set(sizes) == {"dead_time", "second_lag"}
    assert sizes["dead_time"]["theta"].value == pytest.approx(1.3, rel=0.01)
    assert sizes["second_lag"]["tau"].value == pytest.approx(2.2, rel=0.01)


def test_the_right_pair_is_proposed_first(log):
    problem = prepared(ideal_flow(), log)
    fits = ranked(candidates(problem, problem.quiet, FEW), False)
    first = proposed(problem, fits)[0]
    assert {first.first.effect.name, first.second.effect.name} == {"dead_time", "second_lag"}
    assert np.isfinite(first.F) and first.starts


def test_an_effect_at_a_place_is_put_in_and_pinned_once_for_all_fits(log):
    """Making a diagram costs as much as several replays of it."""
    problem = prepared(ideal_flow(), log)
    for one in candidates(problem, problem.quiet, FEW):
        near_neutral(one)
    made = held.cache_info().misses
    again = candidates(problem, problem.quiet, FEW)
    for one in again:
        assert one.tried([{one.sizes[0]: one.nominal[one.sizes[0]] + 0.01}])
    assert held.cache_info().misses == made


def test_two_effects_that_set_the_same_parameter_are_no_candidate(log):
    problem = prepared(ideal_flow(), log)
    gain, other = (candidates(problem, problem.quiet, [effect("process_gain")])[0] for _ in range(2))
    assert together(gain, other) is None


def test_the_second_effect_is_set_as_the_first_has_left_the_controller(log):
    """A set-point weight of a controller that scans has other parameters; the search ended in a BlockError."""
    problem = prepared(ideal_flow(), log)
    scan, weight = (candidates(problem, problem.quiet, [effect(name)])[0] for name in ("scan_time", "setpoint_weight"))
    both = together(scan, weight)
    assert both is not None
    (fit,) = both.tried([{"1.period": 2.0, "1.offset": 0.0, "1.present": 1.0, "2.b": 0.5}])
    assert np.isfinite(fit.F)


def test_an_effect_that_is_not_there_is_no_replay(log):
    problem = prepared(ideal_flow(), log)
    (slow,) = candidates(problem, problem.quiet, [effect("valve_rate_limit")])
    assert slow.tried([{}]) == []  # a rate without limit has no block that could be run
    assert len(slow.tried([{"rate": 5.0}])) == 1


def test_beside_a_load_a_lag_is_any_of_its_class():
    # analytic: a lag behind the feed moves the phase of what enters there, one before it does not
    lags = {"positioner_lag", "second_lag", "sensor_lag"}
    made = record("ideal", ("second_lag", "sine_disturbance"), "typical", 9100)
    log = Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")})
    known = [effect(name) for name in (*sorted(lags), "sine_disturbance", "dead_time")]
    causes = diagnose(ideal_flow(), log, catalogue=known, limits=False, progress=False).causes
    sets = [{cause.effect, *cause.ambiguous_with} for cause in causes]
    assert {"sine_disturbance"} in sets and lags in sets
