"""A controller whose output is logged with a feedforward added."""

import numpy as np
import pytest
from stickslip.blocks import FirstOrder, IdealValve, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import ensemble, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

T = np.arange(0.0, 10801.0, 10.0)
INPUTS = {
    "SP": np.repeat(np.random.default_rng(5).uniform(57.0, 63.0, 19).round(1), 60)[: len(T)],
    "W": np.repeat(np.random.default_rng(6).uniform(46.0, 54.0, 14).round(1), 80)[: len(T)],
}
KNOWN = ("positioner_lag", "valve_gain", "process_gain", "sensor_bias", "controller_gain")


def heater():
    """Return a heat exchanger with a measured feed W, whose controller's output has a feedforward added."""
    return wire(
        [
            SampledPI(1.2, 80.0, dt=2.0, low=-100.0, high=100.0, start_op=40.0, inputs=["SP", "PV"], outputs="OP_fb"),
            Sum("OP", {"OP_fb": 1.0, "W": 0.5}, offset=-25.0, name="feedforward"),
            IdealValve(spans={"MV": (0.0, 100.0), "OP": (0.0, 100.0)}),
            Noise("load", sd=0.5, dt=2.0, correlation_time=200.0, name="feed"),
            Sum("Q", {"MV": 1.0, "load": 1.0, "W": -0.6}, offset=30.0, name="heat"),
            FirstOrder(1.5, 60.0, theta=8.0, start=60.0, inputs="Q", outputs="T", name="exchanger"),
            SampledSensor(dt=2.0, sd=0.05, tau=6.0, start=60.0, inputs="T", outputs="PV"),
        ],
        inputs=["SP", "W"],
        name="heater",
    ).with_tolerances({"exchanger.K": 0.1})


def logged(model, seed=1):
    """Return what a historian keeps of a run."""
    signals = ["OP", "PV"]
    run = ensemble(model, T[-1], times=T, inputs=Log(T, INPUTS), seeds=[seed], signals=signals, progress=False)
    return Log(T, {**INPUTS, **{s: run.values[s][0].round(2) for s in signals}})


@pytest.mark.parametrize("name", ["", "positioner_lag"])
def test_an_effect_in_a_loop_with_a_feedforward_is_named_also_where_rows_are_missing(name):
    site = effect(name).insert(heater(), "valve", tau=20.0) if name else heater()
    log = logged(site)
    kept = np.ones(len(T), dtype=bool)
    kept[300:330] = False
    report = diagnose(
        heater(), Log(T[kept], {s: log[s][kept] for s in log.names}), catalogue=[effect(one) for one in KNOWN],
        limits=False, progress=False,
    )  # fmt: skip
    assert [cause.effect for cause in report.causes] == ([name] if name else [])
    if name:
        assert report.causes[0].parameters["tau"].value == pytest.approx(20.0, rel=0.1)


def test_the_report_draws_the_model_with_its_noise_and_marks_three_standard_deviations():
    report = diagnose(heater(), logged(heater()), catalogue=[effect("valve_gain")], limits=False, progress=False)
    assert report.diagram["feed"].params["sd"] == 0.5  # not silenced, as it is for the filter
    labels = [tick.get_text() for tick in report.plot().axes[0].get_yticklabels()]
    assert {"−3", "3"} <= {label.replace("-", "−") for label in labels}
