"""Every law of friction of ``blocks`` behind a continuous PI, known from OP and PV alone, with noise and without.

S and J are those that the stems were given.  A stem that creeps, or that is not pulled off by itself in this loop,
shows S - J only: then its S lies within the interval that is told.
"""

import numpy as np
import pytest
from stickslip.blocks import (
    ChenValve,
    ChoudhuryValve,
    HeValve,
    IdealValve,
    KanoValve,
    LuGreStem,
    Positioner,
    StenmanValve,
    StickSlip,
)
from stickslip.gap.diagnosis import diagnose
from stickslip.gap.effects import effect

from tests.gap.test_own_valve import F_C, F_S, J, S, log_of, loop

LIMITS = ("sensor_saturation", "valve_saturation", "controller_limits")
NAMES = ("stiction", "deadband", "process_gain", "process_time_constant", "sensor_lag", "positioner_lag", *LIMITS)
ONES = [effect(name) for name in NAMES]
CREEPING = {
    "LuGreStem": lambda: [LuGreStem(F_S, F_C, start=0.5)],
    "KanoValve": lambda: [KanoValve(S / 100.0, J / 100.0, dt=1.0, start=0.5)],
}
SAME = {  # as Kano's here, so that its diagnosis is theirs
    "ChoudhuryValve": lambda: [ChoudhuryValve(S / 100.0, J / 100.0, dt=1.0, start=0.5)],
    "ChenValve": lambda: [ChenValve(S / 100.0, J / 100.0, dt=1.0, start=0.5)],
}
OUTSIDE = {  # what its positioner hides no stem of two sizes does
    "Positioner": lambda: [
        Positioner(start=0.5, inputs=["OP", "MV"], outputs="p"),
        StickSlip(F_S, F_C, start=0.5, inputs="p", outputs="MV"),
    ],
}


def told(stem, noise=0.0):
    log = log_of(*stem, noise=noise, duration=2400.0)
    return diagnose(loop(IdealValve(), noise=noise), log, catalogue=ONES, limits=False)


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_stem_that_sticks_at_each_sample_is_named_with_its_size(noise):
    # the law that slides on had S = 5.71 and 6.02 without noise; with noise it was unknown
    (cause,) = told([HeValve.from_bands(S / 100.0, J / 100.0, 1.0, start=0.5)], noise).causes
    assert (cause.effect, cause.place) == ("stiction", "valve")
    assert cause.parameters["S"].value == pytest.approx(S, rel=0.05)
    assert cause.parameters["J"].value == pytest.approx(J, rel=0.05)


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_stem_that_jumps_by_all_that_it_sticks_is_named_with_its_size(noise):
    (cause,) = told([StenmanValve(S / 100.0, dt=1.0, start=0.5)], noise).causes
    assert (cause.effect, cause.place) == ("stiction", "valve")
    for size in ("S", "J"):
        assert cause.parameters[size].value == pytest.approx(S, rel=0.05)


@pytest.mark.parametrize("law", CREEPING)
def test_a_stem_that_shows_its_play_only_is_named_with_an_interval_that_has_its_size(law):
    # expected before: unknown for LuGre's, the limits of a sensor or of a valve for the others
    (cause,) = told(CREEPING[law]()).causes
    assert (cause.effect, cause.place) == ("stiction", "valve")
    shown = cause.parameters["S"]
    assert shown.low <= S <= shown.high
    assert shown.value == pytest.approx(S - J, rel=0.06)


@pytest.mark.parametrize("law", SAME)
def test_a_stem_of_a_law_like_kanos_leaves_the_same_log(law):
    one, kano = (log_of(*stem(), duration=2400.0) for stem in (SAME[law], CREEPING["KanoValve"]))
    for signal in ("OP", "PV"):
        np.testing.assert_array_equal(one[signal], kano[signal])


@pytest.mark.usefixtures("without_hints")
@pytest.mark.parametrize("law", OUTSIDE)
def test_a_stem_of_a_law_that_no_effect_has_is_unknown_and_no_limit(law):
    report = told(OUTSIDE[law]())
    assert report.gap and [cause.effect for cause in report.causes] == ["unknown"]
