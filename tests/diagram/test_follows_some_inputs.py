"""A continuous block whose output follows some inputs at once, while others only move its states.

A controller with external reset is one: its integral takes what a selector behind it let through.
"""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, IdealValve, MinSelect, StateSpace, StickSlip
from stickslip.blocks.nonlinear_system import NonlinearSystem
from stickslip.diagram import simulate, wire
from stickslip.diagram.linear import linearise
from stickslip.diagram.reference import simulate_reference

SETTINGS = {"FC": (0.8, 5.0), "PC": (-2.0, 9.0)}  # K_p, T_i [s]
INPUTS = {"SPF": [0.5, 0.5, 0.9, 0.9], "SPP": [-0.7, -0.7, -0.4, -0.4]}
AT = [0.0, 40.0, 41.0, 120.0]  # s
READS = {"FC": ["SPF", "F", "OP"], "PC": ["SPP", "P", "OP"]}


def by_equations(name):
    K_p, T_i = SETTINGS[name]
    SP, PV, OP = READS[name]
    return Equations(
        name, der=lambda b, OP, T_i: (OP - b) / T_i, out=lambda b, SP, PV, K_p: b + K_p * (SP - PV),
        params={"K_p": K_p, "T_i": T_i}, states={"b": 0.4}, inputs=["SP", "PV", "OP"], outputs="OUT",
        labels={"SP": SP, "PV": PV, "OP": OP, "OUT": f"OP_{name}"},
    )  # fmt: skip


def by_matrices(name):
    K_p, T_i = SETTINGS[name]
    D, B = [[K_p, -K_p, 0.0]], [[0.0, 0.0, 1.0 / T_i]]
    return StateSpace([[-1.0 / T_i]], B, [[1.0]], D, start=[0.4], name=name, inputs=READS[name], outputs=[f"OP_{name}"])


def loop(controller, valve=None):
    return wire(
        [
            controller("FC"), controller("PC"), MinSelect("OP", ["OP_FC", "OP_PC"]), valve or IdealValve(),
            FirstOrder(1.0, 3.0, name="flow", inputs=["MV"], outputs=["F"]),
            FirstOrder(-1.0, 6.0, name="suction", inputs=["MV"], outputs=["P"]),
        ],
        inputs=list(INPUTS),
    )  # fmt: skip


def of_python_control():
    def controller(name):
        K_p, T_i = SETTINGS[name]
        return ct.nlsys(
            lambda t, x, u, params: (u[2] - x[0]) / T_i, lambda t, x, u, params: x[0] + K_p * (u[0] - u[1]),
            inputs=READS[name], outputs=[f"OP_{name}"], states=["b"], name=name,
        )  # fmt: skip

    parts = [
        controller("FC"), controller("PC"),
        ct.nlsys(None, lambda t, x, u, params: min(u), inputs=["OP_FC", "OP_PC"], outputs=["OP"], name="low"),
        ct.tf2ss([1.0], [3.0, 1.0], inputs=["OP"], outputs=["F"], name="flow"),
        ct.tf2ss([-1.0], [6.0, 1.0], inputs=["OP"], outputs=["P"], name="suction"),
    ]  # fmt: skip
    return ct.interconnect(parts, inplist=list(INPUTS), outlist=["OP", "F", "P"], name="override")


@pytest.fixture(scope="module")
def published():
    """What python-control's own simulator says; its states are those of the controllers first."""
    t = np.linspace(0.0, 120.0, 121)
    given = [np.interp(t, AT, values) for values in INPUTS.values()]
    tight = {"rtol": 1e-9, "atol": 1e-11, "max_step": 0.1}
    return ct.input_output_response(of_python_control(), t, given, [0.4, 0.4, 0, 0], solve_ivp_kwargs=tight).outputs


@pytest.mark.parametrize("controller", [by_equations, by_matrices])
@pytest.mark.parametrize("simulator", [simulate, simulate_reference])
def test_a_selector_behind_two_controllers_is_as_python_control_has_it(controller, simulator, published):
    run = simulator(loop(controller), 120.0, every=1.0, inputs={s: (AT, v) for s, v in INPUTS.items()})
    acts = run.log["OP"] == run.log["OP_FC"]
    assert 10 < acts.sum() < 110, "both controllers act"
    for signal, expected in zip(["OP", "F", "P"], published, strict=True):
        np.testing.assert_allclose(run.log[signal], expected, atol=2e-6)


def test_python_control_simulates_such_a_diagram_itself(published):
    t = np.linspace(0.0, 120.0, 121)
    given = [np.interp(t, AT, values) for values in INPUTS.values()]
    tight = {"rtol": 1e-8, "atol": 1e-10, "max_step": 0.1}
    response = ct.input_output_response(loop(by_equations), t, given, [0.4, 0.4, 0.0, 0.0], solve_ivp_kwargs=tight)
    shown = response.outputs[response.output_labels.index("OP")]
    np.testing.assert_allclose(shown, published[0], atol=2e-6)


def test_a_stem_that_sticks_behind_it_is_as_the_reference_has_it():
    diagram = loop(by_equations, StickSlip())
    given = {s: (AT, v) for s, v in INPUTS.items()}
    runs = [simulator(diagram, 120.0, every=1.0, inputs=given) for simulator in (simulate, simulate_reference)]
    assert len(runs[0].events) > 2
    np.testing.assert_allclose(runs[0].log["F"], runs[1].log["F"], atol=1e-6)


def test_it_is_linearised():
    found = linearise(wire([by_equations("FC")], inputs=READS["FC"])).system(READS["FC"], ["OP_FC"])
    np.testing.assert_allclose(np.asarray(found.D), [[0.8, -0.8, 0.0]], atol=1e-9)  # analytic: K_p


def test_which_inputs_are_followed():
    assert by_equations("FC").kernels.feeds == (0, 1)
    assert by_matrices("FC").kernels.feeds == (0, 1)
    parts = [
        ct.ss([], [], [], [[2.0]], name="k", inputs=["a"], outputs=["y"]),
        ct.tf2ss([1], [1, 1], name="f", inputs=["b"], outputs=["z"]),
    ]
    both = ct.interconnect(parts, inplist=["b", "a"], outlist=["y", "z"], name="both")
    assert NonlinearSystem(both).kernels.feeds == (1,)


def test_a_ring_that_is_followed_all_round_is_refused():
    ring = Equations("ring", out=lambda a, b: a + b, inputs=["a", "b"], outputs="c")
    with pytest.raises(ValueError, match="algebraic loop"):
        wire([ring, Equations("back", out=lambda c: c, inputs="c", outputs="b")], inputs=["a"])
