"""A stem that sticks, or plays, beside another effect: both are named, and which of the two the stem is."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.gap.generator import record

KNOWN = ("stiction", "deadband", "sensor_noise", "process_gain")


def named(effects, seed, catalogue, share=0.5, given=None):
    """Return the causes of the first ``share`` of a typical record of another program, by name, and its notes."""
    made = record("ideal", effects, "typical", seed, given=given)
    rows = slice(round(share * len(made.signals["time"])))
    log = Log(made.signals["time"][rows], {s: made.signals[s][rows] for s in ("SP", "PV", "OP")})
    known = [effect(name) for name in catalogue]
    report = diagnose(ideal_flow(), log, catalogue=known, limits=False, progress=False)
    return {cause.effect: cause for cause in report.causes}, made, report.notes


def test_more_noise_is_named_beside_a_play_that_is_good_enough_alone():
    # twice the stated noise is a note: the record's own factor is 2.1
    more = {"sensor_noise": {"factor": 2.6}}
    causes, made, _ = named(("deadband", "sensor_noise"), 9101, KNOWN, 1.0, given=more)
    assert set(causes) == {"deadband", "sensor_noise"}
    true = made.effects["sensor_noise"]["factor"]
    assert causes["sensor_noise"].parameters["factor"].value == pytest.approx(true, rel=0.05)


def test_noise_of_nearly_twice_the_stated_one_is_a_note_beside_a_stem_that_creeps():
    # the stem creeps (LuGre's law): alone it leaves what no play would
    causes, made, notes = named(("stiction", "sensor_noise"), 9100, KNOWN)
    assert set(causes) == {"stiction"}
    assert causes["stiction"].parameters["S"].low <= made.effects["stiction"]["S"]
    said = next(note for note in notes if note.startswith("noise.sd is stated as"))
    assert float(said.split()[-1].rstrip(".")) == pytest.approx(
        0.004 * made.effects["sensor_noise"]["factor"], rel=0.06
    )


def test_a_stem_that_creeps_beside_another_effect_is_no_play():
    causes, made, _ = named(("stiction", "controller_gain"), 9100, ("stiction", "deadband", "controller_gain"))
    assert set(causes) == {"stiction", "controller_gain"}
    S, J = (made.effects["stiction"][key] for key in ("S", "J"))
    sizes = causes["stiction"].parameters
    assert sizes["S"].low <= S <= sizes["S"].high and sizes["J"].low <= J <= sizes["J"].high
