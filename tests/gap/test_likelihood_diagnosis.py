"""What the one likelihood finds in a loop that no exact filter has: nonlinear, scanned and continuous."""

from collections.abc import Sequence

import pytest
from stickslip.gap import diagnose
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.gap.insertion.effect import Effect

from tests.gap.root_tank import logged, tank

FEW = [one for one in CATALOGUE if one.name not in ("stiction", "deadband")]  # banks of stems take most of the time
GAINS_AND_TIMES = ("controller_gain", "controller_integral_time", "process_gain", "process_time_constant", "valve_gain")
LAGS_AND_LOADS = ("sensor_lag", "second_lag", "dead_time", "sine_disturbance", "step_disturbance", "sensor_drift")
ALIKE = [effect(name) for name in (*GAINS_AND_TIMES, *LAGS_AND_LOADS)]  # the whole catalogue is asked for one of them
STATED = {"sd": 0.018, "time": 45.0, "noise": 0.003}  # wrong by 1.8, 2.2 and 1.3: a plant's load is not known better


@pytest.mark.parametrize(("scanned", "known"), [(True, CATALOGUE), (False, FEW)], ids=["scanned", "continuous"])
def test_a_load_of_another_size_than_stated_is_a_note_and_no_gap(scanned: bool, known: Sequence[Effect]) -> None:
    log = logged(tank(scanned), 11, duration=2400.0)
    report = diagnose(tank(scanned, **STATED), log, catalogue=known, limits=False)
    assert not report.gap
    assert any("feed.sd is stated as 0.018" in note for note in report.notes)


@pytest.mark.parametrize(
    ("name", "place", "size", "scanned", "known"),
    [
        ("controller_gain", "controller", {"factor": 1.15}, True, ALIKE),
        ("controller_integral_time", "controller", {"factor": 1.5}, False, ALIKE),
        ("process_gain", "tank", {"factor": 1.15}, True, CATALOGUE),
        ("sensor_lag", "sensor", {"tau": 8.0}, True, ALIKE),
        ("sine_disturbance", "feed", {"amplitude": 0.02, "period": 300.0, "phase": 0.2}, True, ALIKE),
    ],
)
def test_effects_are_in_the_named_set_with_their_size(
    name: str, place: str, size: dict[str, float], scanned: bool, known: Sequence[Effect]
) -> None:
    true = effect(name).insert(tank(scanned), place, **size)
    log = logged(true, 12, duration=2400.0)
    report = diagnose(tank(scanned, **STATED), log, catalogue=known, limits=False)
    assert report.gap and report.where is not None
    (cause,) = report.causes
    assert name in (cause.effect, *cause.ambiguous_with)
    assert place in report.where.confidence_set
    if cause.effect == name:
        key = next(iter(size))
        assert cause.parameters[key].value == pytest.approx(size[key], rel=0.15)
