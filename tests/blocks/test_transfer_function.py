"""Transfer functions: against partial fractions, the difference equation, python-control's poles, and refusals."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import TransferFunction
from stickslip.diagram import drive, ensemble, wire


def test_a_step_has_its_closed_form():
    log = drive(TransferFunction([2.0, 3.0], [1.0, 3.0, 2.0]), 5.0, every=1.0, rtol=1e-10, atol=1e-12, u=1.0).log
    # analytic: (2 s + 3)/((s + 1)(s + 2))/s = 1.5/s - 1/(s + 1) - 0.5/(s + 2)
    np.testing.assert_allclose(log["y"], 1.5 - np.exp(-log.t) - 0.5 * np.exp(-2.0 * log.t), atol=1e-9)


def test_equal_degrees_pass_a_step_on_at_once():
    block = TransferFunction([2.0, 1.0], [1.0, 4.0])
    log = drive(block, 1.0, every=0.5, rtol=1e-10, atol=1e-12, u=3.0).log
    np.testing.assert_allclose(log["y"], 0.75 + 5.25 * np.exp(-4.0 * log.t), atol=1e-9)  # analytic
    assert block.kernels.feeds and not TransferFunction([1.0], [1.0, 4.0]).kernels.feeds


def test_coefficients_of_any_size_are_right():
    """States scaled by den: the same process with time in seconds and in nanoseconds."""
    slow = drive(TransferFunction([3.0], [1.0, 0.4, 1.0, 0.2]), 20.0, every=1.0, u=1.0).log["y"]
    f = 1e-9  # time unit
    fast = TransferFunction([3.0], [f**3, 0.4 * f**2, f, 0.2])
    log = drive(fast, 20.0 * f, every=f, u=1.0).log["y"]
    np.testing.assert_allclose(log, slow, atol=2e-4)
    assert log[-1] > 1.0


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(0.2, 3.0), min_size=1, max_size=5), st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=5),
       st.sampled_from([0.0, 0.5]))  # fmt: skip
def test_matrices_have_the_frequency_response_of_the_coefficients(den, num, dt):
    den = [1.0, *den]
    num = num[: len(den)]
    block = TransferFunction(num, den, dt)
    A, B, C, D = block.matrices()
    for at in (0.3 + 0.9j, -1.7 + 0.2j):
        expected = np.polyval(num, at) / np.polyval(den, at)
        got = C @ np.linalg.solve(at * np.eye(len(A)) - A, B) + D
        assert got[0, 0] == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("num", "den"), [([1.0, 0.3], [1.0, -0.6, 0.2]), ([2.0, 0.0, 1.0], [2.0, -1.0, 0.3])])
def test_sampled_ones_follow_the_difference_equation(num, den):
    u = np.sin(0.8 * np.arange(12))
    log = drive(TransferFunction(num, den, 0.5), 5.5, every=0.5, u=(0.5 * np.arange(12), u)).log
    b = np.pad(num, (len(den) - len(num), 0))
    y = np.zeros(12)
    for k in range(12):  # analytic
        past = [(j, k - j) for j in range(len(den)) if k >= j]
        y[k] = (sum(b[j] * u[i] for j, i in past) - sum(den[j] * y[i] for j, i in past if j)) / den[0]
    np.testing.assert_allclose(log["y"], y, atol=1e-12)


@pytest.mark.parametrize("dt", [0.0, 1.0])
def test_it_starts_at_rest_where_asked(dt):
    block = TransferFunction([4.0], [1.0, -0.2, 0.3] if dt else [5.0, 1.0, 2.0], dt, start=3.0)
    u = 3.0 * (1.1 if dt else 2.0) / 4.0
    np.testing.assert_allclose(drive(block, 20.0, every=1.0, u=u).log["y"], 3.0, atol=1e-9)
    integrator = TransferFunction([2.0], [1.0, 0.0], start=1.0)
    np.testing.assert_allclose(drive(integrator, 2.0, every=1.0, u=0.5).log["y"], [1.0, 2.0, 3.0], atol=1e-9)


def test_coefficients_are_parameters():
    diagram = wire([TransferFunction([3.0], [10.0, 1.0], name="lag")], inputs=["u"])
    many = ensemble(diagram, 10.0, inputs={"u": 1.0}, params={"lag.a_1": [5.0, 10.0]}, every=10.0)
    assert many.values["y"][:, -1] == pytest.approx(3.0 * (1.0 - np.exp([-2.0, -1.0])), abs=1e-5)  # analytic


def test_python_control_sees_its_poles():
    block = TransferFunction([1.0], [1.0, 2.0, 5.0])
    poles = ct.linearize(block, block.x0, [0.0]).poles()
    np.testing.assert_allclose(sorted(poles, key=np.imag), [-1.0 - 2.0j, -1.0 + 2.0j], atol=1e-6)
    held = ct.c2d(ct.tf([1.0], [1.0, 2.0, 5.0]), 0.1, "zoh")
    twin = TransferFunction(held.num_array[0, 0], held.den_array[0, 0], 0.1).smooth()
    np.testing.assert_allclose(
        sorted(np.linalg.eigvals(twin.matrices()[0]), key=np.imag), [-1 - 2j, -1 + 2j], atol=1e-6
    )


REFUSALS = {
    "improper": (lambda: TransferFunction([1.0, 0.0, 0.0], [1.0, 1.0], name="PD"), ["PD", "degree 2", "filter"]),
    "no den": (lambda: TransferFunction([1.0], [0.0]), ["not zero"]),
    "nan": (lambda: TransferFunction([1.0], [1.0, float("nan")]), ["a_0"]),
    "dt": (lambda: TransferFunction([1.0], [1.0, 1.0], -0.1), ["dt = -0.1"]),
    "order": (lambda: TransferFunction([1.0], [1.0, 1.0]).with_params(n=2), ["order 1"]),
    "leading": (lambda: TransferFunction([1.0], [1.0, 1.0]).with_params(a_1=0), ["a_1 = 0"]),
    "start": (lambda: TransferFunction([1.0, 0.0], [1.0, 1.0], start=2.0), ["start = 2.0", "rests at 0"]),
}


@pytest.mark.parametrize("what", REFUSALS)
def test_refusals(refuses, what):
    refuses(*REFUSALS[what])
