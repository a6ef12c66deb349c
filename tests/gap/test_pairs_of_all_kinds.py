"""Two effects of which one is found by a search of its own: a limit, a plan, a stem, noise."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect

# what is put in: two effects, each (name, place, sizes); and what else is in the catalogue
CASES = {
    "a gain and a stop": (
        (("process_gain", "process", {"factor": 0.9}), ("valve_saturation", "valve", {"low": 0.0, "high": 58.0})),
        ("controller_gain", "sensor_bias", "dead_time"),
    ),
    "a lag and a late step": (
        (("second_lag", "process", {"tau": 2.0}), ("step_disturbance", "feed", {"amplitude": 0.015, "time": 1300.0})),
        ("dead_time", "sensor_bias", "process_gain"),
    ),
    "more noise and a sine": (
        (("sensor_noise", "sensor", {"factor": 3.0}),
         ("sine_disturbance", "feed", {"amplitude": 0.005, "period": 60.0, "phase": 0.3})),
        ("sensor_bias", "process_gain", "slug"),
    ),
    "a play and a late step": (
        (("deadband", "valve", {"width": 2.0}), ("step_disturbance", "feed", {"amplitude": 0.015, "time": 1300.0})),
        ("stiction", "sensor_bias", "process_gain"),
    ),
    # a small dead time beside the play makes matters worse, so that slopes speak for the others
    "a play and a dead time": (
        (("deadband", "valve", {"width": 2.2}), ("dead_time", "process", {"theta": 1.7})),
        ("sensor_bias", "process_gain", "process_time_constant", "controller_gain", "sensor_lag", "positioner_lag"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_both_are_named_with_their_sizes(case, with_effects):
    both, others = CASES[case]
    catalogue = [effect(name) for name in (*(name for name, _, _ in both), *others)]
    causes = diagnose(ideal_flow(), with_effects(3, *both), catalogue=catalogue, limits=False, progress=False).causes
    found = {cause.effect: cause.parameters for cause in causes}
    assert set(found) == {name for name, _, _ in both}
    for name, _, values in both:
        size = next(key for key in values if key not in ("low", "time", "phase", "period"))
        assert found[name][size].value == pytest.approx(values[size], rel=0.05), name
