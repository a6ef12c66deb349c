"""Sizes at a sensor whose span no block states: PV may be in any unit."""

import numpy as np
import pytest
from stickslip.blocks import Equations, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import ensemble, wire
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.logs import Log

SP, OP, BIAS = 40.0, 50.0, 5.0  # [degC, %, degC]


def _bath(T, MV, load):
    heated = 20.0 * 30.0 ** (MV / 100.0 - 0.5)
    return (heated + load - (T - 20.0)) / 300.0


def bath(T=SP):
    """Return a bath that a valve of equal percentage heats; at ``SP`` it rests."""
    return wire(
        [
            SampledPI(2.0, 300.0, dt=10.0, low=0.0, high=100.0, start_op=OP),
            IdealValve(),
            Noise("load", sd=0.3, dt=10.0, correlation_time=200.0, name="heat"),
            Equations("bath", der=_bath, states={"T": T}, inputs=["MV", "load"], outputs="T"),
            SampledSensor(10.0, sd=0.05, start=SP, inputs="T", outputs="PV"),
        ],
        inputs=["SP"],
    )


def test_a_bias_of_some_degrees_is_named():
    # expected before: no bias was looked for beyond 0.5 of any unit
    t = 30.0 * np.arange(900)
    inputs = Log(t, {"SP": np.where(t % 9000.0 < 4500.0, SP, SP + 4.0)})
    plant = effect("sensor_bias").insert(bath(SP - BIAS), "sensor", offset=BIAS)
    run = ensemble(plant, t[-1], times=t, inputs=inputs, seeds=[3], signals=["OP", "PV"], progress=False)
    log = Log(t, {"SP": inputs["SP"], **{s: run.values[s][0] for s in ("OP", "PV")}})
    low, high = Hypothesis(held_against(bath(), log), effect("sensor_bias"), "sensor").bounds["offset"]
    assert low < -0.4 * SP and high > 0.4 * SP
    known = [effect(name) for name in ("sensor_bias", "process_gain", "controller_gain")]
    (cause,) = diagnose(bath(), log, catalogue=known, limits=False).causes
    assert (cause.effect, cause.place) == ("sensor_bias", "sensor")
    assert cause.parameters["offset"].value == pytest.approx(BIAS, rel=0.1)
