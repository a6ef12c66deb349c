"""The filters and summits of the methods, against scipy's, which they stand in for."""

import numpy as np
import pytest
from scipy import signal
from stickslip.detect.signals.filters import first_order, smoothed, summits

NOISE = np.random.default_rng(7)


@pytest.mark.parametrize("cut", [0.001, 0.05, 0.3, 0.8])
@pytest.mark.parametrize("n", [21, 500])
def test_smoothing_without_phase(cut, n):
    x = 3.0 + np.cumsum(NOISE.normal(size=n))
    expected = signal.sosfiltfilt(signal.butter(2, cut, output="sos"), x)  # an independent program
    assert smoothed(x, cut) == pytest.approx(expected, abs=1e-8 if cut < 0.01 else 1e-11)


@pytest.mark.parametrize("shape", [(300,), (4, 300)])
def test_first_order(shape):
    x = NOISE.normal(size=shape)
    expected = signal.lfilter([1.0, -0.7], [1.0, -0.95], x)  # an independent program
    assert first_order(x, 1.0, -0.7, -0.95) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("room", [1, 2, 7, 40])
@pytest.mark.parametrize("step", [0.0, 0.5])
def test_summits(room, step):
    """Heights that are all different, and flat tops of a coarse signal whose heights differ by a slow drift."""
    for _ in range(20):
        x = np.cumsum(NOISE.normal(size=200))
        if step:
            x = np.repeat(np.round(x[:50] / step) * step + 1e-3 * NOISE.normal(size=50), 4)
        expected = signal.find_peaks(x, distance=room)[0]  # an independent program
        assert summits(x, room).tolist() == expected.tolist()


@pytest.mark.parametrize("x", [[1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 2.0], np.arange(5.0)])
def test_no_summit(x):
    assert summits(np.array(x), 1).tolist() == []
