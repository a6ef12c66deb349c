"""A small loop whose controller does not scan, with a wandering load: what its filter says with and without a gap."""

import numpy as np
import pytest
from stickslip.blocks import PI, Equations, IdealValve, Noise, Sum
from stickslip.diagram import ensemble, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

FEW = [effect(name) for name in ("positioner_lag", "valve_gain", "sensor_lag", "second_lag", "sensor_bias")]


def tank():
    """A tank with a square-root outflow; its level is held by a continuous PI."""
    blocks = [
        PI(4.0, 100.0, anti_windup="conditional", start_op=0.5),
        IdealValve(spans={"MV": (0.0, 1.0)}),
        Noise("load", sd=0.01, dt=1.0, correlation_time=60.0, name="feed"),
        Sum("q_in", {"MV": 1.0, "load": 1.0}, name="inflow"),
        Equations("vessel", der=lambda h, q_in, A, k: (q_in - k * h**0.5) / A, states={"h": 0.5}, inputs=["q_in"],
                  params={"A": 80.0, "k": 0.7071}),
        Noise("noise", sd=0.002, dt=1.0),
        Sum("PV", {"h": 1.0, "noise": 1.0}, name="LT").with_role("sensor"),
    ]  # fmt: skip
    return wire(blocks, inputs=["SP"], name="tank")


def logged(model, seed):
    """An hour of a tank, a row every 5 s, its set point moved every 10 min."""
    t = np.arange(0.0, 3601.0, 5.0)
    SP = Log(t, {"SP": np.array([0.45, 0.55, 0.5])[(t // 600.0).astype(int) % 3]})
    run = ensemble(model, t[-1], times=t, inputs=SP, seeds=[seed], signals=["OP", "PV"], progress=False)
    return Log(t, {"SP": SP["SP"], **{s: run.values[s][0].round(4) for s in ("OP", "PV")}})


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_lag_that_smooths_the_noise_of_logged_outputs_is_no_gap(seed):
    # a positioner lag of half an interval gains more than 100 nats in each of these records, as it does without any gap
    assert not diagnose(tank(), logged(tank(), seed), catalogue=FEW, limits=False, progress=False).gap


def test_a_gain_of_its_valve_is_named():
    log = logged(effect("valve_gain").insert(tank(), "valve", factor=0.8), 1)
    report = diagnose(tank(), log, catalogue=FEW, limits=False, progress=False)
    assert report.causes[0].effect == "valve_gain" and report.where.place == "valve"
    assert report.causes[0].parameters["factor"].value == pytest.approx(0.8, rel=0.02)
