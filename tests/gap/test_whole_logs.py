"""Logs as a simulation leaves them: every signal, no rounding; set points that switch between two rows."""

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.diagram import simulate
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.framing import when_switched
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.search import model_alone
from stickslip.logs import Log

LEVELS, DWELL = (1.2, 1.6, 1.4), 240.0  # [unit of PV], [s]
EVERY_SIGNAL = ("SP", "OP", "MV", "load", "F", "y", "noise", "PV")


def whole(model):
    inputs = {"SP": Staircase("SP", LEVELS * 4, dwell=DWELL)}
    return simulate(model, 1800.0, every=1.0, inputs=inputs).log


@pytest.mark.parametrize("names", [EVERY_SIGNAL, ("SP", "PV", "OP"), ("SP", "PV", "OP", "F")], ids=len)
def test_the_model_itself_leaves_no_gap(names):
    log = whole(ideal_flow(rest=1.2))
    report = diagnose(ideal_flow(), Log(log.t, {s: log[s] for s in names}), limits=False)
    assert not report.gap, report


def test_an_effect_is_named():
    log = whole(effect("valve_gain").insert(ideal_flow(rest=1.2), "valve", factor=1.2))
    assert set(log.names) > set(EVERY_SIGNAL)
    report = diagnose(ideal_flow(), log, limits=False)
    assert report.where.confidence_set == ("valve",) and report.causes[0].effect == "valve_gain"


LAGS = ("dead_time", "second_lag", "sensor_lag", "positioner_lag", "process_time_constant")
GAINS = ("controller_gain", "controller_integral_time", "process_gain", "setpoint_filter", "setpoint_ramp", "scan_time")
RIVALS = [effect(name) for name in ("stiction", "deadband", *GAINS, *LAGS)]  # of a switch, or of what is put in
BETWEEN = 237.3  # [s]: every level of the set point begins between two rows


def switched(model, digits=6, duration=3600.0):
    """A log of a loop whose set point switches between rows."""
    log = simulate(model, duration, every=1.0, inputs={"SP": Staircase("SP", LEVELS * 6, dwell=BETWEEN)}).log
    return Log(log.t, {s: log[s].round(digits) for s in ("SP", "PV", "OP")})


def test_instants_between_rows_are_found():
    log = switched(ideal_flow(rest=1.2))
    frame = held_against(ideal_flow(), log)
    assert judged_by_loss(model_alone(frame)).unusual  # at the rows themselves they would be a gap
    found = when_switched(frame)
    assert not judged_by_loss(model_alone(found)).unusual
    rows = np.flatnonzero(np.diff(log["SP"])) + 1
    true = BETWEEN * np.arange(1, len(rows) + 1)
    said = np.array([log.t[k] - found.record.leads["SP"].get(int(k), 0.0) for k in rows])
    late = rows >= found.skipped
    assert said[late] == pytest.approx(true[late], abs=0.01)


def test_a_coarse_log_of_such_set_points_leaves_no_gap():
    assert not diagnose(ideal_flow(), switched(ideal_flow(rest=1.2), digits=3), limits=False).gap


@pytest.mark.parametrize(
    ("name", "place", "values"),
    [("controller_gain", "controller", {"factor": 1.2}), ("dead_time", "process", {"theta": 1.5}),
     ("stiction", "valve", {"S": 4.0, "J": 1.5})],
)  # fmt: skip
def test_an_effect_beside_instants_between_rows_is_named(name, place, values):
    log = switched(effect(name).insert(ideal_flow(rest=1.2), place, **values), duration=1800.0)
    report = diagnose(ideal_flow(), log, catalogue=RIVALS, limits=False)
    assert [(cause.effect, cause.place) for cause in report.causes] == [(name, place)], report
    for key, size in values.items():
        assert report.causes[0].parameters[key].value == pytest.approx(size, rel=0.05)
