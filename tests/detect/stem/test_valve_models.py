"""Kano's and He's stems over many sizes at once: closed forms on ramps and triangles."""

import itertools

import numpy as np
import pytest
from stickslip.detect.stem.valve_models import VALVES, he, kano


def one(value):
    return np.array([float(value)])


def triangle(turns, step=0.01):
    return np.concatenate([np.arange(a, b, step if b > a else -step) for a, b in itertools.pairwise(turns)])


@pytest.mark.parametrize("name", list(VALVES))
def test_no_stiction_is_no_valve(name):
    u = np.cumsum(np.random.default_rng(0).normal(size=300))
    assert VALVES[name](u, one(0), one(0))[0] == pytest.approx(u)


def test_kano_on_a_triangle():
    """Analytic: after a turn the stem waits for S, jumps by J and follows (S - J) / 2 behind."""
    u = triangle([0, 10, -10, 10])
    x = kano(u, one(6), one(2))[0]
    down, up = slice(1000, 3000), slice(3000, 5000)
    for part, way in ((down, -1.0), (up, 1.0)):
        moves = np.flatnonzero(np.abs(np.diff(x[part])) > 1e-9)
        start = moves[0]
        assert abs(u[part][start + 1] - u[part][0]) == pytest.approx(6, abs=0.03)
        assert abs(np.diff(x[part])[start]) == pytest.approx(2, abs=0.03)
        assert (x[part] - u[part])[start + 1 :] == pytest.approx(-way * 2.0)
    assert np.max(np.abs(u - x)) == pytest.approx(4, abs=0.02)  # (S + J) / 2, just before the slip


def test_he_steps_along_a_ramp():
    """Analytic: He's stem sticks after every slip, so that a ramp becomes steps of J, f_S to f_D behind OP."""
    u = np.arange(0.0, 40.0, 0.001)
    x = he(u, one(6), one(2))[0]
    jumps = np.diff(x)
    assert jumps[jumps > 0] == pytest.approx(2.0, abs=0.01)
    assert np.max(u - x) == pytest.approx(4.0, abs=0.01)
    assert np.min(u - x) == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("name", list(VALVES))
def test_many_at_once_are_as_one_by_one(name):
    rng = np.random.default_rng(1)
    u = np.cumsum(rng.normal(size=400))
    S = rng.uniform(0, 8, 20)
    J = S * rng.uniform(0, 1, 20)
    together = VALVES[name](u, S, J, -1.0)
    assert together.shape == (20, 400)
    assert all((VALVES[name](u, S[i : i + 1], J[i : i + 1], -1.0)[0] == together[i]).all() for i in range(20))


@pytest.mark.parametrize("name", list(VALVES))
def test_scale_offset_and_sign_carry_over(name):
    u = np.cumsum(np.random.default_rng(2).normal(size=400))
    x = VALVES[name](u, one(3), one(1))[0]
    assert VALVES[name](7 * u + 40, one(21), one(7))[0] == pytest.approx(7 * x + 40)
    assert VALVES[name](-u, one(3), one(1), -1.0)[0] == pytest.approx(-x)


def test_kano_is_the_valve_of_the_loop_in_the_tests(sticky):
    """An independent recursion, written for the tests, in closed loop with noise: the same stem, move by move."""
    record = sticky(noise=0.3)
    middle = 0.5 * (record.op.min() + record.op.max())
    start = int(np.argmax(np.abs(record.op[:150] - middle)))
    x = kano(record.op[start:], one(6), one(4), np.sign(record.op[start] - middle))[0]
    assert x[150:] == pytest.approx(record.mv[start:][150:])
