"""Biquad: SciPy's filter and bilinear transform as oracles, settled starts, refusals."""

import math

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.biquad import Biquad
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.diagram import drive


def test_it_agrees_with_scipy():
    b, a = [0.2, -0.1, 0.4], [-1.2, 0.5]
    u = np.random.default_rng(5).normal(size=60)
    ours = drive(Biquad("y", "u", b, a, dt=0.1), 5.9, every=0.1, u=Staircase("u", list(u), dwell=0.1)).log["y"]
    np.testing.assert_allclose(ours, scipy.signal.lfilter(b, [1.0, *a], u), atol=1e-12)


@given(omega=st.floats(0.05, 2.8), zeta=st.floats(0.2, 2.0))
def test_low_pass_is_the_bilinear_transform_with_its_edge_kept(omega, zeta):
    ours = Biquad.low_pass("y", "u", omega, 1.0, zeta=zeta)
    warped = 2.0 * math.tan(omega / 2.0)
    b, a = scipy.signal.bilinear([warped**2], [1.0, 2.0 * zeta * warped, warped**2], fs=1.0)
    np.testing.assert_allclose(ours.p[:5], [*b, *a[1:]], atol=1e-9)
    z = np.exp(1j * omega)
    gain = (b[0] * z**2 + b[1] * z + b[2]) / (z**2 + a[1] * z + a[2])
    assert abs(gain) == pytest.approx(1.0 / (2.0 * zeta), rel=1e-6)  # analytic: at the edge


def test_a_settled_start_stays():
    for block in (Biquad.low_pass("y", "u", 0.5, 1.0, start=0.7), Biquad("y", "u", [1, 0, 0], [0, 0], 1.0, start=0.7)):
        np.testing.assert_allclose(drive(block, 20.0, every=0.5, u=0.7).log["y"], 0.7, rtol=1e-12)


def test_python_control_sees_the_slow_gain():
    slow = Biquad("y", "u", [0.2, -0.1, 0.4], [-1.2, 0.5], 1.0).smooth()
    assert float(slow.output(0.0, [], [1.0])[0]) == pytest.approx(0.5 / 0.3)  # analytic


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Biquad("y", "u", [1.0, 0.0], [0.0, 0.0], 1.0), "there are three, b_0, b_1 and b_2"),
        (lambda: Biquad("y", "u", [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], 1.0), "there are two, a_1 and a_2"),
        (lambda: Biquad("y", "u", [1, 0, 0], [0.0, 1.1], 1.0), r"a_2 = 1.1, but a stable filter has"),
        (lambda: Biquad("y", "u", [1, 0, 0], [1.6, 0.5], 1.0), r"a_1 = 1.6, but a stable filter has"),
        (lambda: Biquad.low_pass("y", "u", 4.0, 1.0), r"omega = 4.0, but the edge .* pi/dt = 3.14159 rad/s"),
        (lambda: Biquad.low_pass("y", "u", 1.0, 1.0, zeta=0.0), "zeta = 0.0, but a damping is positive"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()
