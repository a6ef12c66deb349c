"""Blocks and diagrams inside python-control's operations: the oracle is its algebra on the transfer functions."""

import control as ct
import numpy as np
import pytest
from scipy.integrate import BDF
from stickslip.blocks import Equations, FirstOrder, StateSpace, TransferFunction
from stickslip.cases import find
from stickslip.diagram import simulate, wire
from stickslip.plant import SET_B, kicked, production_plant

T = np.linspace(0.0, 20.0, 81)
U = np.sin(0.4 * T) + 1.0
G, H = ct.tf([3], [10, 1]), ct.tf([1], [2, 1])
TIGHT = {"rtol": 1e-9, "atol": 1e-11}


def block():
    return FirstOrder(3.0, 10.0, name="process")


def diagram():
    return wire([block()], inputs=["MV"], outputs=["PV"], name="loop")


def equations():
    lag = Equations("lag", der=lambda PV, MV: (3.0 * MV - PV) / 10.0, states={"PV": 0.0}, inputs="MV")
    return wire([lag], inputs=["MV"], outputs=["PV"], name="equations")


def joined(system):
    other = ct.tf([1], [2, 1], inputs="PV", outputs="Y", name="filter")
    junction = ct.summing_junction(["r", "-Y"], "MV", name="sum")
    return ct.interconnect([system, other, junction], inputs="r", outputs="PV")


OPERATIONS = {
    "-s": (lambda s: -s, -G),
    "s * H": (lambda s: s * H, G * H),
    "H * s": (lambda s: H * s, G * H),
    "s * s": (lambda s: s * s, G * G),
    "s + H": (lambda s: s + H, G + H),
    "H - s": (lambda s: H - s, H - G),
    "s - 1": (lambda s: s - 1, G - 1),
    "2 * s": (lambda s: 2 * s, 2 * G),
    "s / 4": (lambda s: s / 4, G / 4),
    "feedback": (lambda s: ct.feedback(s, H), ct.feedback(G, H)),
    "feedback around": (lambda s: ct.feedback(ct.ss(H), s), ct.feedback(H, G)),
    "series": (lambda s: ct.series(s, H), G * H),
    "parallel": (lambda s: ct.parallel(s, H), G + H),
    "interconnect": (joined, ct.feedback(G, H)),
}


@pytest.mark.parametrize("make", [block, diagram, equations])
@pytest.mark.parametrize("what", OPERATIONS)
def test_operations(what, make):
    operation, linear = OPERATIONS[what]
    exact = ct.forced_response(linear, T, U).outputs  # exact for inputs that are linear between samples
    result = operation(make())
    response = ct.input_output_response(result, T, U, solve_ivp_kwargs=TIGHT | {"max_step": 0.25})
    np.testing.assert_allclose(response.outputs, exact, atol=1e-6)


@pytest.mark.parametrize("what", ["s * H", "feedback", "interconnect"])
def test_what_python_control_joined_can_be_wired_again(what):
    operation, linear = OPERATIONS[what]
    system = operation(diagram())
    run = simulate(wire([system], inputs=system.input_labels), 20.0, times=T, rtol=1e-9, atol=1e-12,
                   inputs={system.input_labels[0]: (T, U)})  # fmt: skip
    exact = ct.forced_response(linear, T, U).outputs
    np.testing.assert_allclose(run.log[system.output_labels[0]], exact, atol=1e-6)
    assert run.in_python


@pytest.mark.parametrize("make", [block, diagram])
def test_append_says_what_to_use_instead(make):
    with pytest.raises(TypeError, match=r"diagram\.wire.*ct\.interconnect.*ct\.linearize"):
        ct.append(make(), H)
    linear = ct.append(ct.linearize(make(), [0.0], [0.0]), H)
    assert linear.ninputs == 2


def test_the_linear_blocks_are_ready_for_python_control():
    tf = TransferFunction([3.0], [10.0, 1.0])
    ss = StateSpace([[-0.1]], [[0.3]], [[1.0]])
    for system in (tf, ss):
        response = ct.input_output_response(ct.feedback(system, H), T, U, solve_ivp_kwargs=TIGHT)
        np.testing.assert_allclose(response.outputs, ct.forced_response(ct.feedback(G, H), T, U).outputs, atol=1e-6)


@pytest.mark.parametrize("stem", ["quasi_static", "full"])
def test_a_stiff_solver_keeps_its_step_beside_a_stuck_stem(stem):
    """Where a stuck stem had slopes of exactly 0 BDF stepped aside until it broke away: 50,000 calls a second."""
    plant = kicked(production_plant(SET_B, F_s=2250.0, stem=stem))
    u = np.zeros(plant.ninputs)
    solver = BDF(lambda t, x: plant.dynamics(t, x, u), 0.0, plant.x0, 1.5, rtol=1e-6, atol=1e-9)
    while solver.status == "running" and solver.nfev < 10_000:
        solver.step()
    assert solver.t == 1.5


@pytest.mark.parametrize("method", ["RK45", "LSODA", "BDF", "Radau"])
def test_every_method_of_python_control_simulates_the_thesis_loop(method):
    """BDF and Radau did not end while the slopes of a stuck stem were exactly 0."""
    loop = find("ideal_high").build()
    ours = simulate(loop, 300.0, every=1.0).log
    theirs = ct.input_output_response(loop, ours.t, 0, loop.x0, solve_ivp_method=method)
    assert np.abs(theirs.outputs[loop.output_labels.index("PV")] - ours["PV"]).max() < 1e-3
