"""Logs as a simulation leaves them: every signal, no rounding."""

import pytest

from blocks import Staircase
from cases.models import ideal_flow
from diagram import simulate
from gap import diagnose
from gap.effects import effect
from logs import Log

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
