"""Structural isolability: which logged signals feel an effect follows from the wiring (analytic)."""

import pytest
from stickslip.cases.models import ideal_flow, level_cascade
from stickslip.gap.effects import effect
from stickslip.gap.reporting.structure import by_wiring, felt, structure

CASCADE = {"SP_L", "L", "SP", "PV", "OP"}
SHOWN = [
    ("valve_gain", "valve", ("PV", "L")),  # the flow is measured by one sensor, and fills the vessel
    ("sensor_bias", "sensor", ("PV",)),
    ("sensor_bias", "level_sensor", ("L",)),
    ("process_gain", "vessel", ("L",)),
    ("controller_gain", "level_controller", ("SP",)),
    ("controller_gain", "controller", ("OP",)),
]


@pytest.mark.parametrize(("name", "place", "signals"), SHOWN)
def test_an_effect_shows_in_the_logged_signals_that_its_place_reaches(name, place, signals):
    assert set(felt(level_cascade(), CASCADE, effect(name), place)) == set(signals)


def test_a_logged_stem_parts_what_is_before_it_from_what_is_behind():
    loop = ideal_flow()
    with_mv = {"SP", "PV", "OP", "MV"}
    assert felt(loop, with_mv, effect("stiction"), "valve") == ("MV",)
    assert felt(loop, with_mv, effect("valve_gain"), "valve") == ("PV",)
    both = {"stiction", "valve_gain"}
    for known, groups in (({"SP", "PV", "OP"}, 1), (with_mv, 2)):
        found = structure(loop, known, [effect(name) for name in sorted(both)])
        assert len(found) == groups
        assert {name for one in found for name, _ in one.effects} == both
    (one,) = structure(loop, {"SP", "PV", "OP"}, [effect("stiction"), effect("valve_gain")])
    assert "MV" in one.tags


def test_the_sentence_names_places_that_need_a_shape_or_a_tag():
    said = by_wiring(level_cascade(), CASCADE)
    assert "valve, process, feed show in L and PV only (a log of MV or F would part them)" in said
    assert by_wiring(ideal_flow(), {"SP", "PV", "OP"}, [effect("controller_gain")]).endswith("signals of its own.")
