"""What the one likelihood finds in a loop that no exact filter has: nonlinear, scanned and continuous."""

from collections.abc import Sequence

import pytest
from stickslip.gap import diagnose
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.gap.insertion.effect import Effect

from tests.gap.root_tank import logged, tank

FEW = [one for one in CATALOGUE if one.name not in ("stiction", "deadband")]  # banks of stems take most of the time
STATED = {"sd": 0.018, "time": 45.0, "noise": 0.003}  # wrong by 1.8, 2.2 and 1.3: a plant's load is not known better


@pytest.mark.parametrize(("scanned", "known"), [(True, CATALOGUE), (False, FEW)], ids=["scanned", "continuous"])
def test_a_load_of_another_size_than_stated_is_a_note_and_no_gap(scanned: bool, known: Sequence[Effect]) -> None:
    report = diagnose(tank(scanned, **STATED), logged(tank(scanned), 11), catalogue=known, limits=False)
    assert not report.gap
    assert any("feed.sd is stated as 0.018" in note for note in report.notes)


@pytest.mark.parametrize(
    ("name", "place", "size", "scanned"),
    [
        ("controller_gain", "controller", {"factor": 1.15}, True),
        ("controller_integral_time", "controller", {"factor": 1.5}, False),
        ("process_gain", "tank", {"factor": 1.15}, True),
        ("sensor_lag", "sensor", {"tau": 8.0}, True),
        ("sine_disturbance", "feed", {"amplitude": 0.02, "period": 300.0, "phase": 0.2}, True),
    ],
)
def test_effects_are_in_the_named_set_with_their_size(
    name: str, place: str, size: dict[str, float], scanned: bool
) -> None:
    true = effect(name).insert(tank(scanned), place, **size)
    report = diagnose(tank(scanned, **STATED), logged(true, 12, duration=3600.0), limits=False)
    assert report.gap and report.where is not None
    (cause,) = report.causes
    assert name in (cause.effect, *cause.ambiguous_with)
    assert place in report.where.confidence_set
    if cause.effect == name:
        key = next(iter(size))
        assert cause.parameters[key].value == pytest.approx(size[key], rel=0.15)
