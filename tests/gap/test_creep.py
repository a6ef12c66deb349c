"""A stem that creeps: bristles (``stickslip.blocks.lugre_stem``) in a loop with noise; S and J analytic, of F_s, F_c
and k.
"""

import pytest
from stickslip.blocks import LuGreStem
from stickslip.cases.models import ideal_flow
from stickslip.gap import diagnose
from stickslip.gap.answers.report import Size
from stickslip.gap.effects import effect
from stickslip.gap.records.model import read
from stickslip.gap.reporting.creep import about_creep, coarse, creeps, least_sizes
from stickslip.logs import Log

from benchmarks.gap.generator import record

SPRING = 30000.0  # N per travel
F_S, F_C = 900.0, 300.0  # N: breaks away 3 % behind OP, slides 1 % behind it
S, J = 100.0 * (F_S + F_C) / SPRING, 100.0 * (F_S - F_C) / SPRING  # 4 %, 2 %


def size(value):
    return Size(value, 0.9 * value, 1.1 * value, "% OP")


def test_of_bristles_in_a_noisy_loop_the_log_says_s_less_j_only(recorded, logged):
    stem = LuGreStem(F_S, F_C, k=SPRING, start=0.5, low=-1.0, high=2.0, name="stem")
    found = logged(ideal_flow(rest=1.5).insert("MV", stem), recorded(seed=3), 3)
    report = diagnose(ideal_flow(), found, catalogue=[effect("stiction"), effect("deadband")])
    (cause,) = report.causes
    assert cause.effect == "stiction" and cause.ambiguous_with == ()
    sizes = cause.parameters
    assert sizes["S"].value - sizes["J"].value == pytest.approx(S - J, rel=0.1)
    assert sizes["S"].low < S < sizes["S"].high and sizes["J"].low <= J < sizes["J"].high
    assert "creeps" in str(report)


def test_only_a_stiction_that_hardly_jumps_creeps():
    stiction, deadband = effect("stiction"), effect("deadband")
    assert creeps(stiction, {"S": size(2.0), "J": size(0.1)})
    assert not creeps(stiction, {"S": size(2.0), "J": size(0.5)})
    assert not creeps(deadband, {"width": size(2.0)})
    wide = least_sizes(stiction, {"S": size(2.1), "J": size(0.1)})
    assert (wide["S"].value, wide["S"].low, wide["J"].value) == (2.0, 2.0, 0.0)
    assert wide["S"].high - wide["J"].high == pytest.approx(2.0)  # S - J is known


def test_a_deadband_is_said_to_be_a_stem_that_creeps_as_well():
    assert "S - J = 2 %" in about_creep(effect("deadband"), {"width": size(2.0)})[0]
    assert about_creep(effect("valve_gain"), {"factor": size(1.1)}) == []
    assert about_creep(effect("stiction"), {"S": size(2.0), "J": size(1.0)}) == []


def test_a_log_of_few_digits_shows_op_in_steps_only(recorded):
    log = recorded()
    assert not coarse(*read(ideal_flow(), log))  # six digits
    rounded = Log(log.t, {**{s: log[s] for s in ("SP", "PV")}, "OP": log["OP"].round(3)})
    assert coarse(*read(ideal_flow(), rounded))


def test_a_play_of_another_program_is_a_deadband():
    # the benchmark's generator shares no code with the diagnosis: the best play leaves 0.5 % of its gap, no jump less
    made = record("ideal", ["deadband"], "gross", seed=7778, family="tuning")
    log = Log(made.signals["time"][:2400], {s: made.signals[s][:2400] for s in ("SP", "PV", "OP")})
    few = [effect(name) for name in ("deadband", "stiction", "dead_time")]
    (cause,) = diagnose(ideal_flow(), log, catalogue=few, limits=False, progress=False).causes
    assert cause.effect == "deadband"
    assert cause.parameters["width"].value == pytest.approx(made.effects["deadband"]["width"], rel=1e-3)
