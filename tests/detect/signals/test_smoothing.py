import numpy as np
import pytest
from stickslip.detect.signals.smoothing import moving_average, noise_std


def test_a_line_stays_a_line_on_uneven_time():
    t = np.cumsum(np.random.default_rng(0).uniform(0.1, 2.0, 200))
    assert moving_average(t, 3 * t - 5, 4.0) == pytest.approx(3 * t - 5)  # analytic


def test_sine_shrinks_by_sinc():
    t = np.linspace(0, 100, 20001)
    y = moving_average(t, np.sin(2 * np.pi * t / 10), 3.0)
    assert y[5000:15000] == pytest.approx(np.sinc(0.3) * np.sin(2 * np.pi * t / 10)[5000:15000], abs=1e-5)  # analytic


def test_whole_period_takes_the_wave_off():
    t = np.arange(0.0, 500.0, 0.5)
    y = moving_average(t, 7 + np.sin(2 * np.pi * t / 50), 100.0, ends="hold")
    assert y == pytest.approx(7.0, abs=1e-3)  # analytic


def test_input_is_left_alone():
    t, x = np.arange(10.0), np.arange(10.0) ** 2
    kept = x.copy()
    moving_average(t, x, 3.0)
    moving_average(t, x, 0.0)[0] = 99
    assert (x == kept).all()


@pytest.mark.parametrize("sigma", [0.02, 0.1, 0.5])
@pytest.mark.parametrize("uneven", [False, True])
def test_noise_is_found_under_a_wave(sigma, uneven):
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.3, 1.7, 4000)) if uneven else np.arange(4000.0)
    x = np.sin(2 * np.pi * t / 50) + rng.normal(0, sigma, 4000)
    assert noise_std(t, x) == pytest.approx(sigma, rel=0.1)  # analytic


def test_clean_sine_reads_as_clean():
    t = np.arange(2000.0)
    assert noise_std(t, np.sin(2 * np.pi * t / 50)) < 1e-4
