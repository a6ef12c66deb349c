"""A run that gains of another model drive away is given up: near a root its steps become ever smaller."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from stickslip.blocks import Equations, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import simulate, wire
from stickslip.diagram.diagram import Diagram
from stickslip.engine.status import Status
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.hypothesis import MORE, Hypothesis, Innovations
from stickslip.gap.likelihood.search import model_alone
from stickslip.logs import Log

from tests.gap.root_tank import framed

TOP = 5.569  # what the sensor would show at most [bar]


def _vessels(p1: float, p2: float, MV: float, w_in: float) -> tuple[float, float]:
    flow = 0.5 * MV * math.sqrt(max(p1 * p1 - p2 * p2, 0.0))
    return (w_in - flow) / 8.0, (flow - p2 / 3.0) / 2.0


def two_vessels() -> Diagram:
    """Return a pressure controller of two gas vessels, between which the flow goes with a root."""
    return wire(
        [
            SampledPI(0.3, 20.0, dt=0.5, T_t=0.5, start_op=0.5, action="direct", name="controller"),
            IdealValve(),
            Noise("w_in", sd=0.03, dt=0.5, correlation_time=60.0, mean=1.0),
            Equations(
                "vessels", der=_vessels, states={"p1": 5.0, "p2": 3.0}, inputs=["MV", "w_in"], outputs="p1"
            ),
            SampledSensor(0.5, sd=0.01, tau=1.0, start=5.0, name="sensor", inputs="p1", outputs="PV"),
        ],
        inputs=["SP"],
    )  # fmt: skip


@cache
def alone() -> Innovations:
    """Return what the right model leaves of a record with steps of the set point."""
    t = np.arange(0.0, 900.0, 2.0)
    set_point = np.where(t < 200.0, 5.0, np.where(t < 500.0, 5.5, 4.9))
    run = simulate(two_vessels(), 900.0, every=2.0, inputs={"SP": (t, set_point)})
    log = Log(t, {"SP": set_point, "PV": run.log["PV"][: len(t)], "OP": run.log["OP"][: len(t)]})
    return model_alone(framed(two_vessels(), log)).best


def test_a_filter_says_how_many_steps_it_took() -> None:
    assert len(alone().hypothesis.frame.stops[0]) < alone().steps < 1e6


def test_a_run_with_other_gains_takes_many_times_as_many_at_most() -> None:
    one = Hypothesis(alone().hypothesis.frame, effect("sensor_saturation"), "sensor")
    values = {**alone().values, "high": TOP}
    assert one.filtered(values, alone()).steps == alone().steps  # what it is measured by in its turn
    with pytest.raises(ArithmeticError, match=f"status {int(Status.TOO_MANY_STEPS)}"):
        one.filtered(values, replace(alone(), steps=alone().steps // (2 * MORE)))
