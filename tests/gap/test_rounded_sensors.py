"""Sensors that round to steps near their noise, and valves whose lag, law and unit are their own, in plain numpy."""

import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, Noise, SampledPI, SampledPID, SampledSensor
from stickslip.diagram import wire
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.digits import most_noise
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.likelihood.stems import _range
from stickslip.gap.records.model import nuisances, smoothed
from stickslip.gap.reporting.segment import abnormal_segment
from stickslip.logs import Log

SD, STEP, SCAN = 0.05, 0.1, 4.0  # of the sensor, and of the controller [s]
K_P, T_I, T_D, T_F = 4.0, 60.0, 30.0, 16.0
LOAD, SLOW = 0.3, 200.0  # standard deviation and correlation time of the load


def model(sd=SD, step=STEP):
    return wire(
        [
            SampledPID(K_P, T_I, T_D, T_f=T_F, dt=SCAN, high=100.0, integral="present", start_op=50.0, start_SP=50.0,
                       start_PV=50.0),
            Noise("load", sd=LOAD, dt=SCAN, correlation_time=SLOW),
            Equations("process", der=lambda y, OP, load, tau=40.0: (OP + load - y) / tau, states={"y": 50.0},
                      inputs=["OP", "load"]),
            SampledSensor(SCAN, sd=sd, step=step, start=50.0, inputs="y", outputs="PV"),
        ],
        inputs=["SP"],
    )  # fmt: skip


def every_second_scan(rows=1500):
    """The same loop by plain recursions, of which the log has every second scan."""
    rng, y, f, z, load, found = np.random.default_rng(5), 50.0, 50.0, 50.0, 0.0, []
    for k in range(2 * rows):
        sp = 50.0 + 2.0 * (k // 300 % 2)
        pv = STEP * np.round((y + SD * rng.normal()) / STEP)
        new = f + SCAN / (T_F + SCAN) * (pv - f)
        z += K_P * SCAN / T_I * (sp - pv)
        op, f = K_P * (sp - pv) + z - K_P * T_D * (new - f) / SCAN, new
        found.append((SCAN * k, sp, op, pv))
        keeps = np.exp(-SCAN / SLOW)
        load = keeps * load + LOAD * np.sqrt(1.0 - keeps**2) * rng.normal() if k else LOAD * rng.normal()
        y += (1.0 - np.exp(-SCAN / 40.0)) * (op + load - y)
    t, sp, op, pv = np.array(found[::2]).T
    return Log(t, {"SP": sp, "OP": op.round(4), "PV": pv.round(4)})


def test_the_noise_of_a_sensor_is_told_beside_what_it_rounds_off():
    # rounding the mean of the filter as well made 0.075 of 0.05, and no row that is not logged has this mean's rounding
    alone = model_alone(held_against(model(), every_second_scan()))
    assert alone.best.values["sensor.sd"] == pytest.approx(SD, rel=0.1)
    assert np.nanstd(alone.best.e, axis=0) == pytest.approx(1.0, abs=0.06)


def test_rounding_is_noise_where_noise_is_not_far_below_the_step():
    (_, fine), (_, coarse) = (nuisances(model(sd)) for sd in (SD, 0.3 * STEP))
    assert fine.rounding == pytest.approx(STEP / np.sqrt(12.0)) and coarse.rounding == 0.0  # analytic
    steps = [smoothed(model(sd))["sensor"].params["step"] for sd in (SD, 0.3 * STEP)]
    assert steps == [0.0, STEP]


def valve(der, out):
    law = Equations("valve", der=der, out=out, states={"u": 50.0}, inputs=["OP"], outputs="Q")
    return law.with_role("valve", OP="OP", MV="Q")


BENT = valve(lambda u, OP: (OP - u) / 3.0, lambda u: 17000.0 * 30.0 ** (u / 100.0 - 1.0))
SHARE = FirstOrder(0.01, 8.0, name="valve", inputs="OP", outputs="Q").with_role("valve", OP="MV", MV="PV")
BEHIND = (
    FirstOrder(0.01, 3.0, start=0.5, name="positioner", inputs="OP", outputs="u").with_role("filter"),
    Equations("valve", out=lambda u: 0.35 * u + 0.65 * u * u, inputs=["u"], outputs="Q").with_role(
        "valve", OP="u", MV="Q"
    ),
)


@pytest.mark.parametrize(("blocks", "S"), [((BENT,), 5.0), ((SHARE,), 0.05), (BEHIND, 0.05)])
def test_a_stem_sticks_by_a_share_of_op_whatever_the_valve_gives(blocks, S):
    # S of 5 % was 4.25 of 17,000 behind the law of the first, and 425 % of the travel of the second
    loop = wire([SampledPI(1.0, 50.0, dt=1.0, low=10.0, high=95.0, start_op=50.0), *blocks], inputs=["SP", "PV"])
    made = effect("stiction").insert(loop, "valve", S=5.0, J=2.0)["valve:stiction"]
    assert made.params["S"] == pytest.approx(S)
    assert made.params["J"] == pytest.approx(0.4 * S)


def test_bands_of_a_stem_behind_a_positioner_are_shares_of_how_far_op_goes():
    # OP in per cent over an opening from 0 to 1 gave bands of 100 times OP's travel, and a play was named a lag
    loop = wire(
        [
            SampledPI(1.0, 50.0, dt=1.0, high=100.0, start_op=50.0), *BEHIND,
            Noise("load", sd=0.01, dt=1.0, correlation_time=50.0),
            Equations("process", der=lambda y, Q, load: (Q + load - y) / 20.0, states={"y": 0.3375},
                      inputs=["Q", "load"]),
            SampledSensor(1.0, sd=0.001, start=0.3375, inputs="y", outputs="PV"),
        ],
        inputs=["SP"],
    )  # fmt: skip
    t = np.arange(200.0)
    log = Log(t, {"SP": 0.3375 + 0.0 * t, "OP": 50.0 + 8.0 * np.sin(t / 9.0), "PV": 0.3375 + 0.05 * np.sin(t / 9.0)})
    low, high = _range(Hypothesis(held_against(loop, log), effect("deadband"), "valve"))
    assert (low, high) == pytest.approx((0.32, 16.0), rel=0.01)  # analytic: OP goes 16 %


@pytest.mark.parametrize(("low", "offset"), [(100.0, -6.0), (0.0, 0.0), (-np.inf, 0.0)])
def test_a_wrong_span_keeps_the_low_end_of_the_range(low, offset):
    # a stranger's 6 % about 100 degrees was a span and a bias, two causes
    sensor = wire([SampledSensor(1.0, low=low, high=180.0, inputs="y", outputs="PV")], inputs=["y"])
    made = effect("sensor_span").insert(sensor, "sensor", factor=1.06)["sensor:sensor_span"].params
    assert (made["w_in"], made["offset"]) == pytest.approx((1.06, offset))  # analytic


def test_an_output_is_wrong_by_itself_only_beside_measurements_that_are_right():
    frame = held_against(model(), every_second_scan(400))
    left = np.array([1.0, -1.0] * 200)[:, None] * np.sqrt([2.0, 6.0])  # mean squares of PV and OP
    assert abnormal_segment(frame, left) == ("controller",)
    assert "process" in abnormal_segment(frame, left, several=True)  # OP answers to a scan of PV that no row has
    assert abnormal_segment(frame, left * np.sqrt([0.55, 1.0]), several=True) == ("controller",)
    too_small = left * np.sqrt([0.35, 0.1735])  # 0.7 and 1.04: noise that was fitted too large
    assert "process" in abnormal_segment(frame, too_small)


def test_levels_stand_for_no_more_noise_than_they_make():
    # a valve that leaks by 7 % in a letdown station was a coarse sensor at 95 %, with 20 times the stated noise
    frame = held_against(model(step=0.005), every_second_scan(60))
    noisier = Hypothesis(frame, effect("sensor_noise"), "sensor")
    assert most_noise(noisier, 0.02) == pytest.approx(2.0 * np.hypot(1.0, 0.02 / np.sqrt(12.0) / SD))  # analytic
    assert most_noise(noisier, 20.0 * SD) > 10.0 and most_noise(noisier, 0.0) == 2.0
