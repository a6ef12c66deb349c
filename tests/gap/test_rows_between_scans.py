"""A sensor that scans more often than its log is written: a right model has no gap at any interval of the rows."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, IdealValve, SampledSensor
from stickslip.cases.models import ideal_flow, site_flow
from stickslip.diagram import ensemble, wire
from stickslip.gap.diagnosis import diagnose, held_against
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.framing import frame_of, when_switched
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read
from stickslip.logs import Log

from tests.gap.aerated_tank import aerated, aerated_model

NOISE = 0.004
ONES = [effect(name) for name in ("scan_time", "controller_gain", "controller_filter", "sensor_lag", "dead_time")]


def scanned_flow(rest):
    """A continuous PI that sees a new value of its sensor each second."""
    return wire(
        [
            PI(0.4, 10.0, start_op=rest / 3.0),
            IdealValve(),
            FirstOrder(3.0, 10.0, start=rest, inputs="MV", outputs="y"),
            SampledSensor(1.0, sd=NOISE, start=rest, inputs="y", outputs="PV"),
        ],
        inputs=["SP"],
    )


def record(model, every, seed, rows=1200):
    t = every * np.arange(rows)
    SP = np.where(t % 600.0 < 300.0, 1.5, 1.65)
    run = ensemble(model, t[-1], times=t, inputs=Log(t, {"SP": SP}), seeds=[seed], signals=["OP", "PV"])
    return Log(t, {"SP": SP, "OP": run.values["OP"][0], "PV": run.values["PV"][0]})


@pytest.mark.parametrize(("every", "seed"), [(1.0, 31), (1.7, 32), (2.0, 33), (3.0, 34), (5.0, 35), (7.0, 36)])
def test_a_right_model_has_no_gap_however_often_its_log_is_written(every, seed):
    # expected: none; at 2 s a scan_time of 0.2 s was named, at 1.7 s a controller_gain of 1.01
    model = scanned_flow(1.5)
    report = diagnose(model, record(model, every, seed), catalogue=ONES, limits=False)
    assert not report.gap and not report.causes, str(report)


@pytest.mark.parametrize(("every", "seed"), [(1.7, 41), (2.0, 42)])
def test_nor_has_one_whose_noise_is_a_block_of_its_own(every, seed):
    model = ideal_flow(1.5)
    report = diagnose(model, record(model, every, seed), catalogue=ONES, limits=False)
    assert not report.gap and not report.causes, str(report)


def test_what_noise_adds_to_an_output_between_rows_is_all_that_is_left_of_it():
    # analytic: the scan between two rows adds K_p/T_i x 1 s x noise to OP, and the one at the row nothing unknown
    model = scanned_flow(1.5)
    null_model = held_against(model, record(model, 2.0, 1)).null_model
    assert null_model.L[0, 0] == pytest.approx(0.4 / 10.0 * NOISE, rel=0.05)


def test_only_white_noise_of_a_sensor_is_drawn_anew():
    log = record(scanned_flow(1.5), 2.0, 1)
    assert read(scanned_flow(1.5), log)[1].fresh == {"PV": (1.0, 0.0)}
    assert read(ideal_flow(1.5), log)[1].fresh == {"PV": (1.0, 0.0)}
    assert read(scanned_flow(1.5).with_params({"sensor.sd": 0.0}), log)[1].fresh == {}
    assert read(scanned_flow(1.5).with_params({"sensor.correlation_time": 9.0}), log)[1].fresh == {}
    assert read(site_flow(1.5), log)[1].fresh == {}  # beside a load that nobody measures offsets last


def test_a_scan_that_is_slower_than_the_model_says_is_still_named():
    plant = effect("scan_time").insert(scanned_flow(1.5), "controller", period=4.0)
    report = diagnose(scanned_flow(1.5), record(plant, 2.0, 51), catalogue=ONES, limits=False)
    (cause,) = report.causes
    assert cause.effect == "scan_time" and cause.parameters["period"].value == pytest.approx(4.0, rel=1e-3)


def test_when_a_controller_scans_is_asked_again_once_its_set_point_switches_where_it_did():
    # rows are no multiple of the scan, and set points switch between rows: wrong instants hide when scans are
    log = aerated(1)
    f = when_switched(frame_of(*read(aerated_model(), log)))
    assert max(map(abs, checks(Hypothesis(f).filtered({})).values())) < 5.0
