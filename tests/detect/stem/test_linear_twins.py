"""Linear twins: the same colour, the same linear answer to OP, and nothing else in common with it."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.stem.linear_twins import linear_twins
from stickslip.detect.stem.stick import stick


def pair(n=3000, seed=0):
    rng = np.random.default_rng(seed)
    u = np.sin(np.arange(n) / 15.0) + np.cumsum(0.05 * rng.normal(size=n))
    return u, lfilter([0.2], [1, -0.8], u), rng


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_twin_of_a_linear_answer_is_itself(sign):  # analytic: nothing is left to shift
    u, y, _ = pair()
    for twin in linear_twins(u, sign * y, 47.0, sign):
        assert np.std(twin - sign * y) < 0.03 * np.std(y)


def test_twin_keeps_the_noise(sign=1.0):
    u, y, rng = pair()
    noisy = y + 0.3 * rng.normal(size=len(y))
    for twin in linear_twins(u, noisy, 47.0, sign):
        left, ours = noisy - y, twin - y
        assert np.std(ours) == pytest.approx(np.std(left), rel=0.1)
        assert abs(np.corrcoef(left[300:], ours[300:])[0, 1]) < 0.15


def test_twin_of_a_stick_does_not_stand():
    u, _, _ = pair()
    x = stick(4.0 * u, 3.0, 3.0)
    stands = float(np.mean(np.diff(x) == 0.0))
    assert stands > 0.7
    assert all(float(np.mean(np.diff(twin) == 0.0)) < 0.1 for twin in linear_twins(u, x, 47.0, 1.0))
