"""A record may begin anywhere: with loads under way, a level that nobody splits, and a pipe that is full."""

import numpy as np
import pytest
from stickslip.blocks import (
    Divide,
    Equations,
    FirstOrder,
    IdealValve,
    Noise,
    Product,
    SampledPI,
    SampledSensor,
    Square,
    VariableDelay,
)
from stickslip.diagram import simulate, wire
from stickslip.gap.diagnosis import held_against
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.logs import Log


def drum():
    """Return a level that is water and swell; nobody measures the firing, which makes the swell."""
    return wire(
        [
            SampledPI(0.5, 400.0, dt=2.0, low=0.0, high=100.0, start_op=50.0, inputs=["SP", "L"]),
            IdealValve(spans={"OP": (0.0, 100.0), "MV": (0.0, 100.0)}),
            Noise("q", sd=6.0, dt=2.0, correlation_time=120.0, name="firing"),
            Equations("drum", der=_water_and_swell, out=lambda z, y: z + y, states={"z": 0.0, "y": 0.0},
                      inputs=["MV", "q"], outputs="level"),
            SampledSensor(2.0, sd=1.0, inputs="level", outputs="L"),
        ],
        inputs=["SP"],
    )  # fmt: skip


def _water_and_swell(z, y, MV, q):
    return 0.02 * (MV - 50.0), (q - y) / 25.0


def cut(model, seconds, first, every):
    """Return the log of a model from a time on, which nobody knows the state at."""
    source = Square("SP", 10.0, 2000.0)
    run = simulate(wire([source, *model.blocks]), seconds, every=every)
    assert run.ok
    rows = run.log.t >= first
    return Log(run.log.t[rows] - first, {s: run.log[s][rows] for s in ("SP", "L", "OP")})


def test_states_that_loads_have_moved_are_not_believed_to_be_known():
    """What the first rows show is water and swell together; 10 mm too much of one made a load of twice its size."""
    f = held_against(drum(), cut(drum(), 9000.0, 1000.0, 3.0))
    alone = Hypothesis(f)
    usual = alone.filtered({}).nll
    slower = alone.filtered({"firing.sd": 11.0, "firing.correlation_time": 450.0}).nll
    assert usual < slower - 20.0
    assert f.unsure["drum.z"] == pytest.approx(float(np.std(f.record.log["L"])), rel=0.2)


def dosing():
    """Return a residual behind a pipe whose dead time goes by a logged flow."""
    return wire(
        [
            SampledPI(8.0, 450.0, dt=20.0, low=0.0, high=100.0, start_op=30.0, inputs=["SP", "PV"]),
            Product("paced", ["OP", "F"], factor=1 / 300.0, name="pacing"),
            IdealValve(inputs="paced", outputs="MV", spans={"OP": (0.0, 100.0), "MV": (0.0, 100.0)}),
            FirstOrder(12.0, 10.0, start=360.0, inputs="MV", outputs="dose", name="pump"),
            Divide("c_in", "dose", "F"),
            Equations("plug", out=lambda F, V=60.0: 3600.0 * V / F, inputs="F", outputs="theta"),
            VariableDelay("c_late", "c_in", "theta", dt=20.0, longest=1200.0, start=1.2, name="pipe"),
            Noise("demand", sd=0.05, dt=20.0, correlation_time=3600.0, name="water"),
            Equations("tank", der=lambda c, c_late, demand, F: F / 54000.0 * (c_late - demand - c), states={"c": 1.2},
                      inputs=["c_late", "demand", "F"], outputs="c"),
            SampledSensor(20.0, sd=0.01, start=1.2, inputs="c", outputs="PV"),
        ],
        inputs=["SP", "F"],
    )  # fmt: skip


def test_a_filter_follows_a_dead_time_that_varies():
    """Its own values turn round in the block, 62 of them: no filter spreads these."""
    flow = Equations("flow", out=lambda t: 300.0 + 60.0 * np.sin(2.0 * np.pi * t / 20000.0), outputs="F")
    steps = Square("SP", 0.1, 12000.0, mean=1.2)
    run = simulate(wire([flow, steps, *dosing().blocks]), 60000.0, every=40.0)
    assert run.ok
    f = held_against(dosing(), Log(run.log.t, {s: run.log[s] for s in ("SP", "F", "OP", "PV")}))
    assert not f.replays
    alone = Hypothesis(f)
    assert len(alone.names) < 50
    assert np.nanmean(alone.filtered({}).e[f.skipped :] ** 2) == pytest.approx(1.0, abs=0.15)
