"""Relay auto-tuner: amplitude and period of the relay cycle in closed form, the published rules, a loop so tuned."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.relay_tuner import RelayTuner
from stickslip.blocks.sensor import SampledSensor
from stickslip.blocks.sources import Step
from stickslip.diagram import simulate, wire

K, TAU, THETA = 2.0, 10.0, 2.0


def found(tuner, process=None, duration=80.0, SP=0.0):
    process = process or FirstOrder(K, TAU, theta=THETA, inputs="OP")
    run = simulate(wire([Step("SP", SP), tuner, process]), duration, every=duration)
    assert run.ok
    return {key: float(run.log[key][-1]) for key in ("OP", "K_u", "T_u", "K_p", "T_i")}


def cycle(h, e):
    """Analytic: amplitude and period of a relay with hysteresis around a first-order process with dead time."""
    a = K * h - (K * h - e) * math.exp(-THETA / TAU)
    return a, 2.0 * (THETA + TAU * math.log((a + K * h) / (K * h - e)))


@pytest.mark.parametrize(("h", "e"), [(0.1, 0.0), (0.1, 0.02), (0.3, 0.1)])
def test_ultimate_gain_and_period_of_the_relay_cycle(h, e):
    a, T = cycle(h, e)
    values = found(RelayTuner(h, dt=0.01, hysteresis=e))
    assert values["T_u"] == pytest.approx(T, rel=0.01)  # a scan late at each switching
    assert values["K_u"] == pytest.approx(4 * h / (math.pi * math.sqrt(a * a - e * e)), rel=0.015)
    assert values["OP"] == 0.0  # the test is over


def test_the_describing_function_is_near_the_true_ultimate_point():
    # analytic: phase -pi of K exp(-theta s)/(tau s + 1)
    w = brentq(lambda w: w * THETA + math.atan(w * TAU) - math.pi, 0.1, 2.0)
    values = found(RelayTuner(0.1, dt=0.01))
    assert values["K_u"] == pytest.approx(math.sqrt(1 + (w * TAU) ** 2) / K, rel=0.2)
    assert values["T_u"] == pytest.approx(2 * math.pi / w, rel=0.05)


def test_settings_follow_the_published_rules():
    for rule, gain, time in (("Tyreus-Luyben", 1 / 3.2, 2.2), ("Ziegler-Nichols", 0.45, 1 / 1.2)):
        values = found(RelayTuner(0.1, dt=0.05, rule=rule))
        assert values["K_p"] == pytest.approx(gain * values["K_u"]) and values["T_i"] == pytest.approx(
            time * values["T_u"]
        )


def test_direct_action_and_bias():
    falling = FirstOrder(-K, TAU, theta=THETA, inputs="OP", start=-1.0)
    direct = found(RelayTuner(0.1, dt=0.05, bias=0.5, action="direct"), falling, SP=-1.0)
    plain = found(RelayTuner(0.1, dt=0.05))
    assert direct["OP"] == 0.5
    assert direct["K_u"] == pytest.approx(plain["K_u"], rel=0.02) and direct["T_u"] == pytest.approx(
        plain["T_u"], rel=0.02
    )


def test_a_hysteresis_beyond_the_noise_keeps_the_answer():
    parts = [
        Step("SP", 0.0),
        RelayTuner(0.1, dt=0.1, hysteresis=0.02, cycles=5, inputs={"PV": "PV_m"}),
        FirstOrder(K, TAU, theta=THETA, inputs="OP"),
        SampledSensor(dt=0.1, sd=0.004, seed=2),
    ]
    log = simulate(wire(parts), 150.0, every=150.0).log
    a, T = cycle(0.1, 0.02)
    assert log["T_u"][-1] == pytest.approx(T, rel=0.1)
    assert log["K_u"][-1] == pytest.approx(4 * 0.1 / (math.pi * math.sqrt(a * a - 4e-4)), rel=0.2)


@pytest.mark.parametrize("rule", ["Tyreus-Luyben", "Ziegler-Nichols"])
def test_a_loop_with_these_settings_settles(rule):
    values = found(RelayTuner(0.1, dt=0.05, rule=rule))
    pi = PI(values["K_p"], values["T_i"], low=-math.inf, high=math.inf)
    loop = wire([Step("SP", 1.0), pi, FirstOrder(K, TAU, theta=THETA, inputs="OP")])
    run = simulate(loop, 100.0, every=0.1)
    assert np.abs(run.log["PV"][run.log.t > 60.0] - 1.0).max() < 0.03 and run.log["PV"].max() < 1.8


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"amplitude": 0.0}, "amplitude = 0.0, but it must be positive"),
        ({"hysteresis": -1.0}, "hysteresis = -1.0"),
        ({"cycles": 0}, "cycles = 0.0, but it is a whole number of cycles; give 1 or more"),
        ({"cycles": 1.5}, "cycles = 1.5"),
        ({"rule": "Ziegler"}, "did you mean 'Ziegler-Nichols'"),
        ({"action": "up"}, "action = 'up'"),
        ({"dt": 0.0}, "dt = 0.0, but it must be positive"),
    ],
)
def test_misuse_is_explained(change, words):
    with pytest.raises(BlockError, match=words):
        RelayTuner(**({"amplitude": 0.1, "dt": 0.1} | change))
