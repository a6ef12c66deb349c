"""Fits of shapes to half waves against a general least-squares solver and closed forms."""

import numpy as np
import pytest
from stickslip.detect.half_waves.half_wave_fits import free_triangle, gather, relay, relay_wave, sine, triangle
from stickslip.detect.half_waves.waves import HalfWave


def half(y, m=2000):
    """A half wave sampled at midpoints, so that plain sums are midpoint integrals."""
    x = (np.arange(m) + 0.5) / m
    phase = np.concatenate([[0.0], x, [1.0]])
    return HalfWave(0, phase, np.concatenate([[0.0], y(x), [0.0]]), 1.0, 1.0)


def bent(x, apex):
    return np.where(x < apex, x / apex, (1 - x) / (1 - apex))


def test_a_square_has_the_errors_of_the_integrals():
    """Analytic: 1 - 8 / pi^2 for the sine, 1 - (1/2)^2 / (1/3) = 1/4 for the triangle."""
    x = gather([half(np.ones_like)])
    assert sine(x).error[0] == pytest.approx(1 - 8 / np.pi**2, abs=1e-6)
    assert triangle(x).error[0] == pytest.approx(0.25, abs=1e-6)
    assert sine(x).height[0] == pytest.approx(4 / np.pi, abs=1e-6)


@pytest.mark.parametrize("q", [0.05, 1.0, 7.0])
def test_the_relay_wave_answers_a_relay(q):
    """Analytic: a lag of unit time constant behind a dead time q under a relay of +-1, integrated step by step."""
    dt = 1e-4
    T = q + np.log(2 - np.exp(-q))
    t = np.arange(0.0, T, dt)
    y = np.empty(len(t))
    y[0] = 0.0  # the relay switched when y was zero; its effect comes q later
    for k in range(1, len(t)):
        y[k] = y[k - 1] + dt * ((1.0 if t[k - 1] < q else -1.0) - y[k - 1])
    assert np.abs(relay_wave(t / T, q) - y).max() < 5e-4
    assert abs(y[-1]) < 5e-4  # back at zero after T: the half wave is closed


def test_the_relay_wave_ends_in_triangle_and_square():
    """Analytic limits: q towards 0 and towards infinity."""
    x = np.linspace(0.001, 0.999, 999)
    small = relay_wave(x, 1e-4)
    assert np.abs(small / small.max() - bent(x, 0.5)).max() < 1e-3
    fine = np.linspace(0.0, 1.0, 200_001)
    assert 1 - relay_wave(fine, 600.0).mean() == pytest.approx(2 * np.log(2) / 600, rel=0.01)


def test_relay_finds_its_own_ratio():
    q = 30.0 * (0.05 / 30.0) ** (10 / 24)  # on the grid of 25
    fit = relay(gather([half(lambda x: 7.0 * relay_wave(x, q))]))
    assert fit.parameter[0] == pytest.approx(q)
    assert fit.error[0] < 1e-12 and fit.height[0] == pytest.approx(7.0)


@pytest.mark.parametrize("apex", [0.1, 0.37, 0.9])
def test_free_triangle_finds_the_apex(apex):
    fit = free_triangle(gather([half(lambda x: 2.0 * bent(x, apex))]))
    assert fit.parameter[0] == pytest.approx(apex, abs=1e-3)
    assert fit.error[0] < 1e-5 and fit.height[0] == pytest.approx(2.0, rel=1e-3)


def test_a_sample_on_the_crossing_does_no_harm():
    """Analytic: samples at 0, 1/8, ... of a triangle with its apex at 3/8."""
    x = np.arange(8) / 8
    one = HalfWave(0, np.concatenate([[0.0], x, [1.0]]), np.concatenate([[0.0], bent(x, 3 / 8), [0.0]]), 1.0, 8.0)
    fit = free_triangle(gather([one, one]))
    assert fit.parameter.tolist() == [3 / 8, 3 / 8]
    assert fit.error == pytest.approx(0.0, abs=1e-12)


def test_fits_of_many_equal_those_of_each_by_a_general_solver():
    """The sums over ragged half waves against numpy's least squares, apex by apex."""
    rng = np.random.default_rng(3)
    halves = [half(lambda x: rng.normal(1.0, 0.5, len(x)), m) for m in (5, 23, 8, 61)]
    x = gather(halves)
    together, bent_fit = sine(x), free_triangle(x)
    for k, one in enumerate(halves):
        phase, y = one.phase[1:-1], one.y[1:-1]

        def error(shape, y=y):
            a = np.linalg.lstsq(shape[:, None], y, rcond=None)[0]
            return np.mean((y - a[0] * shape) ** 2)

        assert together.error[k] == pytest.approx(error(np.sin(np.pi * phase)))
        assert bent_fit.error[k] == pytest.approx(min(error(bent(phase, apex)) for apex in phase))


def test_nothing_to_fit_is_refused():
    with pytest.raises(ValueError, match="no half waves"):
        gather([])
