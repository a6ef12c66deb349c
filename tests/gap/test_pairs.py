"""Two effects at once in one segment, where no single one shows the way to the other."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
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


def test_beside_a_load_a_lag_is_any_of_its_class():
    # analytic: a lag behind the feed moves the phase of what enters there, one before it does not
    lags = {"positioner_lag", "second_lag", "sensor_lag"}
    made = record("ideal", ("second_lag", "sine_disturbance"), "typical", 9100)
    half = slice(len(made.signals["time"]) // 2)
    log = Log(made.signals["time"][half], {s: made.signals[s][half] for s in ("SP", "PV", "OP")})
    known = [effect(name) for name in (*sorted(lags), "sine_disturbance", "dead_time")]
    causes = diagnose(ideal_flow(), log, catalogue=known, limits=False, progress=False).causes
    sets = [{cause.effect, *cause.ambiguous_with} for cause in causes]
    assert {"sine_disturbance"} in sets and lags in sets
