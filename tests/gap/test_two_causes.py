"""Two effects in one log: the first becomes part of the model, its sizes free, and the second is searched for again."""

import math

import numpy as np
import pytest
from stickslip.cases.models import site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.gap.records.given import Given
from stickslip.gap.reporting.causes import named_cause, said_of

from tests.gap.outside_loops import site_log
from tests.gap.root_tank import logged, tank

GAINS = ("valve_gain", "process_gain", "controller_gain", "process_time_constant")
FEW = [one for one in CATALOGUE if one.name in (*GAINS, "sensor_lag", "sensor_bias", "sine_disturbance")]


def found(report):
    """Effect, or one that is not told apart from it -> the sizes that a report states."""
    return {name: one.parameters for one in report.causes for name in (one.effect, *one.ambiguous_with)}


def test_a_gain_and_a_load_of_another_program_are_both_named_in_a_scanned_loop():
    report = diagnose(site_flow(), site_log("a gain and a sine of the load"), catalogue=FEW, limits=False)
    causes = found(report)
    assert len(report.causes) == 2 and report.evidence.kind == "pair"
    assert {"process_gain", "sine_disturbance"} <= set(causes)
    assert causes["sine_disturbance"]["amplitude"].value == pytest.approx(0.03, rel=0.05)
    assert causes["sine_disturbance"]["period"].value == pytest.approx(140.0, rel=0.01)
    assert "two causes" in report.headline
    # each has its own share of what the two explain
    assert sum(report.where.shares[one.place] for one in report.causes) == pytest.approx(1.0, abs=0.1)


@pytest.mark.usefixtures("without_hints")
def test_effects_that_no_catalogue_has_are_no_pair_either():
    report = diagnose(site_flow(), site_log("a gain that oscillates"), catalogue=FEW, limits=False)
    assert [one.effect for one in report.causes] == ["unknown"]


def test_two_effects_are_named_where_only_the_likelihood_follows_the_loop():
    both = tank()
    for name, place, size in (
        ("controller_gain", "controller", {"factor": 1.4}),
        ("sensor_lag", "sensor", {"tau": 12.0}),
    ):
        both = effect(name).insert(both, place, **size)
    report = diagnose(tank(), logged(both, 8, duration=3600.0), catalogue=FEW, limits=False)
    causes = found(report)
    assert len(report.causes) == 2
    assert causes["controller_gain"]["factor"].value == pytest.approx(1.4, rel=0.05)
    assert causes["sensor_lag"]["tau"].value == pytest.approx(12.0, rel=0.25)
    assert report.shrinkage is not None and report.shrinkage.fraction > 0.9


def test_a_model_with_a_part_gives_what_both_effects_set():
    model = site_flow()
    gain, lag = effect("valve_gain"), effect("second_lag")
    first = Given(model).with_part(gain.put(model, "valve"), gain, "valve", {"factor": 1.2, "at": math.nan}, True)
    assert first.free["valve:valve_gain.factor"] == gain.bounds(model, "valve")["factor"]
    assert first.stated["valve:valve_gain.factor"] == 1.2
    assert {"process.K": 3.1, **gain.settings(model, "valve", factor=1.3)}.items() <= first.settings(
        {"process.K": 3.1, "valve:valve_gain.factor": 1.3}
    ).items()
    assert "valve" not in first.places(gain) and first.places(lag) == lag.places(model)
    assert first.base.model is model


def test_what_is_not_free_in_a_part_keeps_its_value():
    model = site_flow()
    noise = effect("sensor_noise")
    first = Given(model).with_part(noise.put(model, "sensor"), noise, "sensor", {"factor": 3.0}, False)
    assert not any("sensor_noise" in key for key in first.free)
    assert np.isclose(first.part.sizes({}, {})["factor"].value, 3.0)


def test_one_cause_is_said_with_all_places_that_the_log_does_not_tell_apart():
    lag, slow = effect("positioner_lag"), effect("second_lag")
    one = named_cause([(lag, "valve"), (slow, "process")], {})
    first, *rest = said_of([one], ["valve", "process"])
    assert first.startswith("There is a gap. Place: valve or process. Cause: positioner_lag at valve")
    assert any("cannot be told apart from second_lag" in line for line in rest)
