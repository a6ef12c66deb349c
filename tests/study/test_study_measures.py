"""What is measured of a run, against loops written out and closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks import FirstOrder, Saturation, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.diagram import simulate, wire
from stickslip.logs.oscillation import oscillations
from stickslip.plant.loops import integrating_loop
from stickslip.study import study
from stickslip.study.axes import axes_of
from stickslip.study.design import design
from stickslip.study.measures import Measures, OwnMeasures, limiting, limits, slips, valves
from stickslip.study.points import Points
from stickslip.study.subject import as_subject

from tests.plant.oscillation import period_and_amplitude

T = np.arange(0.0, 200.0, 0.5)


@given(st.lists(st.floats(-10.0, 10.0), min_size=400, max_size=400), st.floats(5.0, 60.0))
def test_many_signals_are_measured_as_one_by_the_loop(noise, period):
    Y = np.array([np.array(noise), np.sin(2.0 * np.pi * T / period) + 0.05 * np.array(noise), np.full(len(T), 3.0)])
    periods, amplitudes = oscillations(T, Y)
    for y, T_found, A in zip(Y, periods, amplitudes, strict=True):
        expected = period_and_amplitude(T, y)  # oracle: the plain loop of the plant's tests
        assert pytest.approx(expected[1], rel=1e-12) == A
        assert T_found == pytest.approx(expected[0], rel=1e-9, nan_ok=True)


def test_a_clipped_sine_is_saturated_as_long_as_it_is_clipped():
    loop = integrating_loop().with_params({"controller.low": -0.5, "controller.high": 0.8})
    t = np.arange(0.0, 2000.0, 0.05)
    OP = np.clip(np.sin(2.0 * np.pi * t / 100.0), -0.5, 0.8)
    found = Measures(loop, ["OP"], 1000.0)(t, {"OP": OP})
    # analytic: above 0.8 for 1/2 - asin(0.8)/pi of the time, below -0.5 for 1/3
    assert found["OP.saturated"] == pytest.approx(0.5 - np.arcsin(0.8) / np.pi + 1.0 / 3.0, abs=2e-3)
    assert found["OP.period"] == pytest.approx(100.0, rel=1e-3)  # the tolerance of a run
    assert found["OP.amplitude"] == pytest.approx(0.65, rel=1e-12)
    other = Measures(loop, ["OP"], 1000.0, {"controller.high": 2.0})(t, {"OP": OP})
    assert other["OP.saturated"] == pytest.approx(1.0 / 3.0, abs=2e-3)


def test_controllers_without_limits_and_measurements_have_no_saturation():
    assert limits(integrating_loop(), ["OP", "PV", "MV"]) == {}


class Clipped(Block):
    """A proportional controller whose limits bear names of their own."""

    role = Role.CONTROLLER
    ports_in = (Port("SP"), Port("PV"))
    ports_out = (Port("OP"),)
    limit_params = ("least", "most")
    kernels = Kernels(out=lambda SP, PV, K_p, least, most: min(max(K_p * (SP - PV), least), most))

    def __init__(self) -> None:
        super().__init__(name="controller", params={"K_p": 1.0, "least": 0.0, "most": 1.0})


def test_limits_are_those_that_the_controller_declares():
    """OP rests at min(2 K_p, most) of a step of 2, K = 0: only where most is below that is it saturated (analytic)."""
    loop = wire([Step("SP", after=2.0), Clipped(), FirstOrder(K=0.0, tau=1.0, inputs="OP")])
    assert limiting(loop, ["OP", "PV"]) == {"OP": ("controller.least", "controller.most")}
    found = study(loop, {"controller.most": [0.5, 3.0, 1.5]}, duration=20.0, every=1.0, progress=False)
    assert found.column("OP.saturated").tolist() == [1.0, 0.0, 1.0]


def test_only_limits_of_what_is_measured_part_the_runs():
    loop = wire([Step("SP", after=2.0), Clipped(), Saturation("MV", "OP"), FirstOrder(K=0.0, tau=1.0)])
    for name, batches in (("MV.low", 1), ("controller.least", 3)):
        plan = design(axes_of("vary", {name: [-1.0, -2.0, -3.0]}), None, 0, None)
        parts, refused = Points(as_subject(loop), plan, None, 0.0, 0).split(range(3))
        assert (len(parts), refused) == (batches, {})


def test_what_stands_still_has_no_period():
    y = 30e5 * (1.0 + 1e-14 * np.sin(T))
    found = Measures(integrating_loop(), ["PV"], 0.0)(T, {"PV": y})
    assert np.isnan(found["PV.period"]) and found["PV.mean"] == pytest.approx(30e5)


def test_slips_are_the_changes_from_stuck_to_sliding():
    loop = integrating_loop()
    run = simulate(loop, 4000.0, every=1.0, start={"process.PV": 0.3})
    from stickslip.diagram import ensemble

    events = ensemble(loop, 4000.0, start={"process.PV": [0.3]}, every=1.0).raw_events[0]
    # oracle: the named events of a plain run
    expected = sum(e.block == "valve" and e.before == "stuck" and e.t >= 1000.0 for e in run.events)
    assert expected >= 4
    assert slips(events, valves(loop), 1000.0) == {"valve": expected}


def test_a_diagram_measures_what_moves_and_kicks_what_is_controlled():
    subject = as_subject(integrating_loop())
    assert subject.signals == ("OP", "MV", "PV") and subject.kicked == ("process.PV",)


def test_own_measures_take_the_place_of_the_usual_ones():
    """The peak of a first order without overshoot is its last value (analytic), inf is empty."""
    own = OwnMeasures(("peak", "never"), lambda t, log: {"peak": float(log["PV"].max()), "never": math.inf})
    loop = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    found = study(loop, {"process.K": [1.0, 2.0]}, duration=500.0, every=1.0, measures=own)
    assert found.table["peak"].to_list() == pytest.approx([1.0, 2.0], rel=1e-3)  # the tolerance of a run
    assert found.table["never"].to_list() == [None, None] and "PV.amplitude" not in found.table.columns
    assert found.request["measures"] == ["peak", "never"]
