"""He's valve: python-control's backlash as oracle, the published steps on a ramp, misuse."""

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.ports import BlockError

from tests.blocks.test_valves_agree import sampled


@settings(max_examples=100)
@given(st.lists(st.floats(0.001, 0.999), min_size=1, max_size=60), st.floats(0.0, 0.3))
def test_equal_bands_are_the_backlash_of_python_control(op, f):
    play = ct.friction_backlash_nonlinearity(2 * f)  # independent: python-control
    play(0.0)
    np.testing.assert_allclose(sampled(HeValve(f, f, 1.0), op), [play(u) for u in op], atol=1e-12)


def test_agrees_with_the_published_running_sum():
    rng = np.random.default_rng(3)
    op = np.clip(50 + np.cumsum(rng.normal(0, 1.5, 2000)), 1, 99)
    f_s, f_d = 4.0, 2.0
    u_r, mv, before, expected = 0.0, 50.0, 50.0, []  # independent transcription of the paper's recursion
    for u in op:
        c = u_r + u - before
        if abs(c) > f_s:
            mv += c - np.sign(c) * f_d
            u_r = np.sign(c) * f_d
        else:
            u_r = c
        before = u
        expected.append(mv)
    valve = HeValve(f_s, f_d, 1.0, low=0.0, high=100.0, start=50.0)
    np.testing.assert_allclose(sampled(valve, op), expected, atol=1e-9)


def test_follows_a_slow_ramp_in_steps_of_J():
    op = np.arange(50.0, 80.0, 0.01)
    mv = sampled(HeValve.from_bands(6.0, 2.0, 1.0, low=0.0, high=100.0, start=50.0), op)
    moves = np.diff(mv)[np.diff(mv) > 0]
    assert np.all((moves >= 2.0 - 1e-9) & (moves <= 2.01 + 1e-9))  # analytic: J and up to one input step
    assert len(moves) == 13  # analytic: (30 - 4)/2.0..2.01, first at f_s = 4


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"f_s = 1.0, but static friction is at least the kinetic one, f_s >= f_d = 2"):
        HeValve(1.0, 2.0, 1.0, high=100.0)
    with pytest.raises(BlockError, match=r"with OP in percent give high=100"):
        HeValve(4.0, 2.0, 1.0)
    with pytest.raises(BlockError, match=r"f_d = -0.1"):
        HeValve(0.1, -0.1, 1.0)
    with pytest.raises(BlockError, match=r"dt = 0.0, but a sampling period is positive"):
        HeValve(0.1, 0.1, 0.0)
