"""Residuals without a gap: white where sensor noise is all, innovations of a filter where a load is not measured."""

import numpy as np
import pytest
from stickslip.blocks import Equations, SampledSensor
from stickslip.cases.models import ideal_flow, site_flow
from stickslip.diagram import wire
from stickslip.gap.diagnosis import held_against
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.null_model.null_model import UNIT, losses, measured, null_model_of, residuals, skipped_rows
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.record import GapError
from stickslip.logs import Log


def test_residuals_of_the_right_model_are_the_sensors_noise(recorded):
    null = model_alone(held_against(ideal_flow(), recorded(seed=3)))
    frame = null.hypothesis.frame
    assert frame.record.pinned == ("OP", "PV") and frame.null_model.changes.tolist() == [True, False]
    assert np.nanstd(null.best.e, axis=0) == pytest.approx([1.0, 1.0], abs=0.1)  # analytic: unit variance
    assert not judged_by_loss(null).unusual and not frame.null_model.coloured
    assert frame.null_model.L[1, 1] == pytest.approx(0.004, rel=0.05)  # analytic: the model's own noise


def test_coloured_residuals_are_whitened():
    rng = np.random.default_rng(0)
    runs, rows, a = 12, 3000, 0.9
    load = np.zeros((runs, rows))
    for k in range(1, rows):
        load[:, k] = a * load[:, k - 1] + rng.normal(size=runs)
    null_model = null_model_of(load[:, :, None])
    e = null_model.innovations(load[:, :, None])[..., 0]
    assert null_model.coloured and null_model.A[0, 0, 0] == pytest.approx(
        a, abs=0.02
    )  # analytic: a first-order autoregression
    assert e.std() == pytest.approx(1.0, abs=0.02)
    assert abs(np.corrcoef(e[:, 1:].ravel(), e[:, :-1].ravel())[0, 1]) < 0.02


def test_a_level_that_wanders_is_differenced():
    walk = np.cumsum(np.random.default_rng(0).normal(size=(12, 3000, 1)), axis=1)
    assert null_model_of(walk).changes.tolist() == [True]
    moved = residuals(walk, np.array([True]))
    assert np.isnan(moved[:, 0]).all() and np.allclose(moved[:, 1:], np.diff(walk, axis=1))


def test_the_loss_of_normal_noise_is_least_at_its_own_size():
    e = np.random.default_rng(0).normal(size=200_000)
    sizes = np.linspace(0.9, 1.1, 21)
    cost = [losses(e / f).sum() + len(e) * np.log(f) for f in sizes]
    assert sizes[int(np.argmin(cost))] == pytest.approx(1.0, abs=0.011) and 0.8 < UNIT < 0.9


def test_the_beginning_of_a_record_is_not_scored():
    assert skipped_rows(7201) == 144 and skipped_rows(1801, 100.0) == 100 and skipped_rows(1801, 4000.0) == 180
    assert skipped_rows(100) == 20 and skipped_rows(30) == 15


def test_missing_samples_are_left_out(recorded):
    log = recorded(seed=3)
    PV = log["PV"].copy()
    PV[500:520] = np.nan
    null = model_alone(held_against(ideal_flow(), Log(log.t, {"SP": log["SP"], "OP": log["OP"], "PV": PV})))
    assert not judged_by_loss(null).unusual and np.isfinite(null.nll)


def test_a_model_that_rests_elsewhere_is_started_where_the_record_starts(recorded):
    from stickslip.gap.records.model import read, silenced
    from stickslip.gap.records.start import start_values

    opened, record = read(site_flow(), recorded(seed=3))  # the model's own start is PV = OP = 0, at a limit
    found = start_values(silenced(opened), record)
    assert found["controller.z"] == pytest.approx(0.5, abs=0.02)  # analytic: OP at rest is PV / K = 1.5 / 3
    assert found["process.PV"] == pytest.approx(1.5, abs=0.03)


def test_a_controller_at_its_limit_is_replayed_exactly(recorded):
    from stickslip.gap.effects import effect

    frame = held_against(ideal_flow(), recorded("controller_limits", "controller", high=55.0))
    found = Hypothesis(frame, effect("controller_limits"), "controller").filtered({"high": 55.0})
    assert (frame.record.log["OP"] >= 0.55).mean() > 0.02  # the record does reach the limit
    assert np.nanmax(np.abs(found.e[:, frame.signals.index("OP")])) < 100.0  # a ride that ends late costs 1e4


def test_a_model_of_which_no_run_ends_is_said_to_be_one():
    # x' = 10 x^3 is beyond all numbers after 0.05 s (analytic); the answer was "the logs have [] rows"
    t = np.arange(200.0)
    log = Log(t, {"u": np.zeros(200), "y": np.linspace(0.0, 0.1, 200)})
    grows = Equations(
        "process", der=lambda x, u, k: k * (x * x * x) + u, states={"x": 1.0}, params={"k": 10.0}, inputs="u"
    )
    model = wire([grows, SampledSensor(dt=1.0, sd=0.01, start=1.0, inputs="x", outputs="y")], inputs=["u"])
    opened, record = read(model, log)
    with pytest.raises(GapError, match=r"none of 40 runs .* came to its end"):
        measured(opened, silenced(opened), record, 40, 1)
