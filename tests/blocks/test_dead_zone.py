"""Dead zone: values, located edges, and what a controller with a gap leaves; expected numbers are analytic."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.dead_zone import DeadZone
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.sources import Step
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference


def test_it_passes_what_lies_beyond_and_tells_when():
    run = drive(DeadZone("y", "u", -0.5, 0.25), 10.0, every=0.1, u=Sine("u", 1.0, 10.0))
    u = np.sin(2 * np.pi * run.log.t / 10.0)
    np.testing.assert_allclose(run.log["y"], u - np.clip(u, -0.5, 0.25), atol=1e-12)
    first = 10 * math.asin(0.25) / (2 * math.pi)
    assert [e.t for e in run.events] == pytest.approx([first, 5 - first, 70 / 12, 110 / 12], abs=1e-9)
    assert [e.after for e in run.events] == ["above", "inside", "below", "inside"]


def test_jumps_across_the_zone_pass_through_it():
    levels = [0.0, 2.0, -3.0, 0.1, 5.0]
    run = drive(DeadZone.of_width("y", "u", 1.0), 5.0, every=1.0, u=Staircase("u", levels, dwell=1.0))
    assert run.log["y"].tolist() == pytest.approx([0.0, 1.5, -2.5, 0.0, 4.5, 4.5])


def gap_loop():
    parts = [Step("SP", 1.0), Sum("e", {"SP": 1.0, "PV": -1.0}), DeadZone("MV", "e", -0.2, 0.2), Integrator(1.0, 2.0)]
    return wire(parts)


def test_a_loop_with_a_gap_stops_at_its_edge():
    # analytic: dPV/dt = (0.8 - PV)/2 from 0: PV = 0.8 (1 - exp(-t/2)); the zone is entered never, the edge approached
    run = simulate(gap_loop(), 20.0, every=0.5, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(run.log["PV"], 0.8 * (1 - np.exp(-run.log.t / 2)), atol=1e-7)
    assert [e.after for e in run.events] == ["above"]
    assert run.statistics.steps < 80


def test_the_reference_agrees():
    loop = wire([Sine("u", 1.0, 7.0), DeadZone("MV", "u", -0.3, 0.4), Integrator(1.0, 2.0)])
    ours = simulate(loop, 30.0, every=0.3, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(loop, 30.0, every=0.3)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-8)
    assert [e.after for e in ours.events] == [e.after for e in theirs.events]


def test_python_control_sees_the_branch_of_the_present_input():
    t = np.linspace(0.0, 10.0, 201)
    seen = ct.input_output_response(DeadZone("y", "u", -0.5, 0.25), t, np.sin(t))
    np.testing.assert_allclose(seen.outputs, np.sin(t) - np.clip(np.sin(t), -0.5, 0.25), atol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: DeadZone("y", "u", 1.0, 1.0), "low = 1.0, but it must be below high = 1.0"),
        (lambda: DeadZone.of_width("y", "u", 0.0), "width = 0.0, but a zone has a positive"),
        (lambda: DeadZone("y", "u", -1.0, 1.0).with_params(high=-2.0), "low = -1.0, but it must be below high = -2.0"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()
