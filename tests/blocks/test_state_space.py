"""Linear systems from matrices: against the matrix exponential, sums by hand, and by their refusals."""

import control as ct
import numpy as np
import pytest
from scipy.linalg import expm
from stickslip.blocks import StateSpace
from stickslip.diagram import drive, ensemble, wire

A = np.array([[-0.5, 2.0, 0.0], [-2.0, -0.5, 1.0], [0.0, 0.0, -0.1]])
B = np.array([[1.0, 0.0], [0.0, 0.5], [0.3, -1.0]])
C = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]])
D = np.array([[0.0, 0.2], [0.0, 0.0]])


@pytest.mark.parametrize("through", [None, D], ids=["strictly proper", "with D"])
def test_steps_follow_the_matrix_exponential(through):
    u = np.array([1.5, -0.7])
    start = np.array([0.1, -0.2, 0.3])
    block = StateSpace(A, B, C, through, start=start)
    assert block.kernels.feeds == (False if through is None else (1,))  # by D, column by column
    log = drive(block, 8.0, every=2.0, rtol=1e-10, atol=1e-12, u_1=u[0], u_2=u[1]).log
    rest = -np.linalg.solve(A, B @ u)
    for i, t in enumerate(log.t):  # analytic
        y = C @ (rest + expm(A * t) @ (start - rest)) + (0.0 if through is None else D @ u)
        assert [log["y_1"][i], log["y_2"][i]] == pytest.approx(y, abs=1e-8)


def test_sampled_systems_follow_the_recursion():
    rng = np.random.default_rng(3)
    a = 0.4 * rng.standard_normal((3, 3))
    block = StateSpace(a, B, C, D, dt=0.5, start=[1.0, 0.0, -1.0])
    log = drive(block, 5.0, every=0.25, u_1=0.3, u_2=1.0).log
    x = np.array([1.0, 0.0, -1.0])
    for k in range(10):  # by hand, each value held until the next instant
        y = C @ x + D @ [0.3, 1.0]
        for row in (2 * k, 2 * k + 1):
            assert [log["y_1"][row], log["y_2"][row]] == pytest.approx(y, abs=1e-12)
        x = a @ x + B @ [0.3, 1.0]


def test_a_gain_has_no_states():
    block = StateSpace([], [], [], [[2.0, -1.0]])
    assert drive(block, 1.0, every=1.0, u_1=3.0, u_2=1.0).log["y"].tolist() == [5.0, 5.0]


def test_entries_are_parameters_that_an_ensemble_can_vary():
    block = StateSpace([[-1.0]], [[1.0]], [[1.0]], name="lag")
    diagram = wire([block.with_params(A_1_1=-0.5)], inputs=["u"])
    many = ensemble(diagram, 60.0, inputs={"u": 1.0}, params={"lag.A_1_1": [-1.0, -0.25]}, every=60.0)
    assert many.values["y"][:, -1] == pytest.approx([1.0, 4.0], abs=1e-4)  # analytic: -1/A


def test_python_control_sees_the_same_system():
    block = StateSpace(A, B, C, D)
    seen = ct.linearize(block, block.x0, [0.0, 0.0])
    for ours, theirs in zip(block.matrices(), (seen.A, seen.B, seen.C, seen.D), strict=True):
        np.testing.assert_allclose(theirs, ours, atol=1e-8)
    np.testing.assert_array_equal(block.matrices()[3], D)


def test_python_control_sees_of_a_sampled_system_the_one_it_is_a_sample_of():
    continuous = ct.ss(A, B, C, D)
    held = ct.c2d(continuous, 0.2, "zoh")
    twin = StateSpace(held.A, held.B, held.C, held.D, dt=0.2).smooth()
    for ours, theirs in zip(twin.matrices(), (A, B, C, D), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-9)
    late = StateSpace([[0.0]], [[1.0]], [[1.0]], dt=1.0)  # z^-1 is the sample of no system
    assert late.smooth().nstates == 0


REFUSALS = {
    "shape of B": (lambda: StateSpace(A, B[:2], C), ["(2, 2)", "(n, m)"]),
    "not finite": (lambda: StateSpace([[np.nan]], [[1.0]], [[1.0]]), ["A_1_1"]),
    "dt": (lambda: StateSpace([[0.5]], [[1.0]], [[1.0]], dt=-1.0), ["dt = -1.0", "give seconds"]),
    "start": (lambda: StateSpace(A, B, C, start=[1.0]), ["3 states"]),
    "size": (lambda: StateSpace(A, B, C).with_params(n=2.0), ["n = 2.0", "built with 3"]),
    "through": (lambda: StateSpace(A, B, C).with_params(D_1_1=2.0), ["no parameter 'D_1_1'"]),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_refusals(refuses, what):
    refuses(*REFUSALS[what])
