"""The likelihood on records of another hand: plants in plain numpy, models wired from their data sheets alone.

The records are an independent simulator's, so a right model has to leave innovations of unit size (analytic).
"""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.gap import diagnose
from stickslip.gap.likelihood.diagnosing import frame_of, when_switched
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.records.model import read
from stickslip.logs import Log

from benchmarks.foreign import trial


def without_gap(plant: str) -> tuple[trial.Wired, Log]:
    """Return the model of a plant and its first record without an effect, whose noise and load are as stated."""
    run = next(one for one in trial.runs() if one.plant == plant and one.group == trial.NONE)
    made, build = run.made(), trial.wired(plant)
    assert build is not None and run.noise_factor == run.load_factor == 1.0
    model = build()
    signals = {signal: factor * made.signals[tag] for signal, (factor, tag) in model.signals.items()}
    return model, Log(made.signals["time"], signals)


def frame(plant: str) -> Frame:
    """Return the frame of a record without a gap."""
    model, log = without_gap(plant)
    found = frame_of(*read(model.diagram, log))
    assert found is not None
    return found


@pytest.mark.parametrize(
    "plant",
    [
        "gas_pressure",  # nonlinear, rows at no multiple of the scan, set points that switch between rows
        "heat_exchanger",  # a dead time of many scans
        "pump_flow",  # an equal-percentage valve
        "split_range",  # lookup tables, whose segments are no states
        "batch_ramp",  # a set point that moves with every scan, an output that stands at its limit
    ],
)
def test_a_right_model_of_another_hand_leaves_innovations_of_unit_size(plant: str) -> None:
    left = model_alone(when_switched(frame(plant))).best
    counted = left.e[left.hypothesis.frame.skipped :]
    assert np.sqrt(np.nanmean(counted**2, axis=0)) == pytest.approx(1.0, abs=0.06)
    assert np.nanmean(np.abs(counted) > 4.5) < 1e-3


def test_a_set_point_that_moves_at_each_row_is_a_ramp_if_that_is_likelier() -> None:
    found = when_switched(frame("batch_ramp"))
    assert found.record.ramps == {"SP"}
    held = Hypothesis(replace(found, record=replace(found.record, ramps=frozenset()))).filtered({})
    assert held.nll > Hypothesis(found).filtered({}).nll + 500.0


def test_a_set_point_that_switches_is_no_ramp() -> None:
    found = when_switched(frame("pump_flow"))
    assert not found.record.ramps
    assert found.record.leads["SP"]


def test_a_right_model_of_another_hand_has_no_gap() -> None:
    model, log = without_gap("pump_flow")
    report = diagnose(model.diagram, log, limits=False)
    assert not report.gap
    assert "No gap" in report.words[0]


@pytest.mark.parametrize(("plant", "effect", "place"), [("pump_flow", "positioner_lag", "valve")])
def test_a_slower_lag_of_the_model_is_named(plant: str, effect: str, place: str) -> None:
    # the plant's positioner has another time constant; so has the model's, where a second lag would leave a gap
    run = next(one for one in trial.runs() if one.plant == plant and one.effect == effect)
    row = trial.diagnosed(run)
    assert row["right_cause"] and row["place"] == place
