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
from stickslip.gap.likelihood.framing import MORE, frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.records.model import read
from stickslip.logs import Log

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
    frame = frame_of(*read(two_vessels(), log))
    assert frame is not None
    return model_alone(frame).best


def test_filters_take_many_times_the_steps_of_the_model_alone_at_most() -> None:
    frame = alone().hypothesis.frame
    steps = Hypothesis(replace(frame, doubts={})).filtered({}).steps
    assert len(frame.stops[0]) < steps < 1e6
    assert frame.most_steps == pytest.approx(MORE * steps, rel=0.2)  # the set point does not switch at stops there


@pytest.mark.parametrize("gains", ["its own", "of the model alone"])
def test_a_filter_that_takes_more_is_given_up(gains) -> None:
    one = Hypothesis(alone().hypothesis.frame, effect("sensor_saturation"), "sensor")
    values, near = {**alone().values, "high": TOP}, None if gains == "its own" else alone()
    assert math.isfinite(one.filtered(values, near).nll)
    tight = one.of(replace(one.frame, most_steps=one.frame.most_steps // (2 * MORE)))
    with pytest.raises(ArithmeticError, match=f"status {int(Status.TOO_MANY_STEPS)}"):
        tight.filtered({**values, "high": TOP - 0.001}, near)
