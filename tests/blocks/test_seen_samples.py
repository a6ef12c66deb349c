"""Blocks that sample, under python-control's solver: which samples they take, and that each response begins afresh."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import KanoValve, Recorded, SampledFunction, SampledPI, Sine, ZeroOrderHold
from stickslip.diagram import wire

COARSE = {"solve_ivp_kwargs": {"max_step": 3.0}}


def rows(diagram, t, **given):
    """Return signal -> values of a response."""
    response = ct.input_output_response(diagram, t, 0, diagram.x0, **COARSE, **given)
    return {name: response.outputs[i] for i, name in enumerate(diagram.output_labels)}


def counter(**more):
    """Counts its samples in a list, which it changes in place."""

    def step(state, u):
        state.append(u)
        return state, len(state)

    return SampledFunction("counter", step, dt=1.0, inputs="u", outputs="count", state=[], **more)


def counting(**more):
    return wire([Sine("u", 1.0, 7.0), counter(**more)])


@pytest.mark.parametrize(("first", "last"), [(0.0, 10.0), (20.0, 30.0), (2.5, 4.5)])
def test_each_response_takes_its_own_samples(first, last):
    diagram = counting()
    rows(diagram, np.linspace(0.0, 12.0, 5))
    t = np.linspace(first, last, 9)
    expected = np.floor(t) - np.ceil(first) + 1.0  # analytic: whole seconds so far
    for _ in range(2):
        np.testing.assert_array_equal(rows(diagram, t)["count"], expected)


def test_an_offset_is_kept():
    counts = rows(counting(offset=0.75), np.array([0.0, 0.7, 0.8, 1.7, 1.8]))["count"]
    assert counts.tolist() == [0.0, 0.0, 1.0, 1.0, 2.0]


def test_samples_lie_on_the_line_between_calls():
    ramp = Recorded("u", [0.0, 10.0], [0.0, 10.0])
    held = rows(wire([ramp, ZeroOrderHold("y", "u", 1.0)]), np.array([0.0, 2.5, 7.25, 9.9]))["y"]
    assert held == pytest.approx([0.0, 2.0, 7.0, 9.0], abs=1e-9)  # analytic: the ramp at the whole second before


def test_a_sampled_valve_sticks_within_its_band():
    wave = Sine("OP", 0.02, 20.0, mean=0.5)
    stuck = wire([wave, KanoValve(0.06, 0.02, 0.5, start=0.5)])
    t = np.linspace(0.0, 40.0, 81)
    assert np.ptp(rows(stuck, t)["MV"]) == 0.0  # analytic: OP travels 0.04 < S
    free = rows(stuck, t, params={"valve.S": 0.02, "valve.J": 0.0})["MV"]
    assert np.ptp(free) == pytest.approx(0.02, abs=2e-3)  # analytic: 0.04 less S


def test_a_function_alone_is_a_discrete_time_system_with_its_state():
    def mean(state, PV):
        state += 0.5 * (PV - state)
        return state, state

    block = SampledFunction("filter", mean, dt=1.0, inputs="PV", outputs="PV_f", state=0.0)
    for _ in range(2):
        response = ct.input_output_response(block, [0.0, 1.0, 2.0], [8.0, 8.0, 8.0])
        assert response.outputs.tolist() == [4.0, 6.0, 7.0]  # analytic


def test_slopes_are_those_of_the_continuous_twin():
    loop = wire([SampledPI(2.0, 10.0, dt=1.0, inputs=["SP", "PV"]), KanoValve(0.06, 0.02, 1.0)], inputs=["SP", "PV"])
    model = ct.linearize(loop, loop.x0, [0.2, 0.1])
    row = loop.output_labels.index("MV")
    assert model.D[row] == pytest.approx([2.0, -2.0], abs=1e-6)  # analytic: K_p through a valve without friction
    assert model.poles() == pytest.approx([0.0], abs=1e-6)
