"""Stems in a diagnosis: modes that no log shows, a play that is friction without jump, a position that is logged."""

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow
from stickslip.diagram import ensemble
from stickslip.gap.diagnosis import diagnose, held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.fit import unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.left import judged_by_loss, left, nearly_all
from stickslip.gap.likelihood.replayed_stems import replayed_stem
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.null_model.modes import CHARGE
from stickslip.gap.null_model.null_model import MECHANICAL
from stickslip.logs import Log

from benchmarks.gap.generator import record

STEMS = [effect("stiction"), effect("deadband")]


def logged(recorded, name, signals, seed=3, **values):
    """Return a record of a valve effect with these signals."""
    log = recorded(seed=seed)
    model = ideal_flow(rest=1.5)
    if name:
        one = effect(name)
        model = one.started(one.insert(model, "valve", **values), "valve", {"SP": 1.5, "PV": 1.5, "OP": 0.5})
    many = ensemble(
        model, log.duration, times=log.t, inputs=Log(log.t, {"SP": log["SP"]}), seeds=[seed], signals=signals,
        progress=False,
    )  # fmt: skip
    return Log(log.t, {"SP": log["SP"], **{s: many.values[s][0].round(6) for s in signals}})


def told(log, name, **values):
    """What a replay with an effect of these values leaves, and what the model alone leaves."""
    frame = held_against(ideal_flow(), log)
    null = model_alone(frame)
    one = Hypothesis(frame, effect(name), "valve" if "valve" in effect(name).places(frame.model) else "process")
    return unfitted(one.filtered({**null.best.values, **values})), null


@pytest.mark.parametrize(
    ("name", "values"),
    [("positioner_lag", {"tau": 2.0}), ("valve_rate_limit", {"rate": 1.0}), ("deadband", {"width": 2.0})],
)
def test_a_logged_stem_leaves_nothing_once_what_moves_it_is_right(recorded, name, values):
    right, null = told(logged(recorded, name, ["OP", "PV", "MV"], **values), name, **values)
    frame = null.hypothesis.frame
    k = frame.record.pinned.index("MV")
    assert not frame.null_model.coloured and frame.null_model.changes[k]
    assert frame.null_model.L[k, k] == MECHANICAL  # of a travel of 1: without a gap MV is OP to the last digit
    assert judged_by_loss(null).unusual and not judged_by_loss(right, null).unusual


def test_a_mode_that_was_missed_is_set_right_and_charged(recorded):
    log = logged(recorded, "stiction", ["OP", "PV"], S=3.0, J=1.2)
    found, _ = told(log, "stiction", S=3.03, J=1.2)  # slips a little late: the next slip back is missed now and then
    assert found.best.charge > 0.0 and found.best.charge % CHARGE == 0.0
    (free,) = found.hypothesis.replayed([found.best.values], modes=False)
    assert left(free) > left(found.best)  # the same replay without other modes


def test_modes_buy_nothing_where_no_stem_sticks(recorded):
    stem, null = told(recorded("valve_leak", "valve", flow=1.0), "stiction", S=3.0, J=1.0)
    assert judged_by_loss(stem, null).unusual and not nearly_all(stem, null)
    assert told(recorded(), "dead_time", theta=1.0)[0].best.charge == 0.0


@pytest.mark.parametrize(("name", "values"), [("deadband", {"width": 2.0}), ("stiction", {"S": 3.0, "J": 1.2})])
def test_of_two_stems_the_one_is_named_that_is_meant(recorded, name, values):
    report = diagnose(ideal_flow(), logged(recorded, name, ["OP", "PV"], **values), catalogue=STEMS, limits=False)
    (cause,) = report.causes
    assert cause.effect == name and not cause.ambiguous_with
    for key, value in values.items():
        assert cause.parameters[key].value == pytest.approx(value, rel=0.01)


def test_sizes_of_a_stem_are_found_where_set_right_modes_make_other_troughs():
    # oracle: the same law in the same loop; with wrong modes set right alone the search ended at S = 13.5, J = 11.5
    t = np.arange(3601.0)
    SP = Log(t, {"SP": np.where(t % 600.0 < 300.0, 1.5, 1.65)})
    site = effect("stiction").insert(ideal_flow(rest=1.5), "valve", S=4.0, J=1.5)
    run = ensemble(site, 3600.0, times=t, inputs=SP, seeds=[1], signals=["OP", "PV"])
    log = Log(t, {"SP": SP["SP"], "OP": run.values["OP"][0].round(6), "PV": run.values["PV"][0].round(6)})
    sizes = diagnose(ideal_flow(), log, catalogue=[effect("stiction")]).causes[0].parameters
    assert sizes["S"].value == pytest.approx(4.0, rel=0.01) and sizes["J"].value == pytest.approx(1.5, rel=0.02)


@pytest.mark.parametrize(("S", "J"), [(3.0, 1.2), (5.0, 4.0)])
def test_sizes_of_a_logged_stem_are_found(recorded, S, J):
    # expected: S and J of the simulation; rows put a logged stem right, so that plain replays are best with twice S of
    # the second one, and replays whose modes are set right find 1.6 times S of the first
    frame = held_against(ideal_flow(), logged(recorded, "stiction", ["OP", "PV", "MV"], S=S, J=J))
    found = replayed_stem(Hypothesis(frame, effect("stiction"), "valve"))
    assert found is not None
    assert found.best.values["S"] == pytest.approx(S, rel=0.01)
    assert found.best.values["J"] == pytest.approx(J, rel=0.02)


def test_a_gap_of_a_logged_stem_lies_at_the_valve_whatever_its_cause(recorded):
    """What it does to the flow shows in PV, too, but a stem that is not where OP holds it proves the valve."""
    few = [effect("dead_time"), effect("controller_gain")]
    log = logged(recorded, "stiction", ["OP", "PV", "MV"], S=6.0, J=3.0)
    assert diagnose(ideal_flow(), log, catalogue=few).where.confidence_set == ("valve",)
    without = logged(recorded, "stiction", ["OP", "PV"], S=6.0, J=3.0)
    assert {"valve", "process"} <= {*diagnose(ideal_flow(), without, catalogue=few).where.confidence_set}


@pytest.mark.parametrize(("severity", "seed"), [("typical", 9631), ("gross", 9642)])
def test_a_stem_in_a_coarse_log_is_told_by_the_level_of_pv(severity, seed):
    # oracle: a program that shares no code with this one; OP is rounded to 0.1 %, which no wrong mode exceeds
    made = record("coarse", ["stiction"], severity, seed)
    third = slice(len(made.signals["time"]) // 3)
    log = Log(made.signals["time"][third], {s: made.signals[s][third] for s in ("SP", "PV", "OP")})
    (cause,) = diagnose(ideal_flow(), log, catalogue=STEMS, limits=False).causes
    assert cause.effect == "stiction"
    assert cause.parameters["S"].value == pytest.approx(made.effects["stiction"]["S"], rel=0.03)
    assert cause.parameters["J"].value == pytest.approx(made.effects["stiction"]["J"], rel=0.1)
