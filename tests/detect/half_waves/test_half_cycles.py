import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.detect.signals.crossings import crossings

from tests.detect.one_by_one import measure


def ratio(t, x, noise=0.0):
    c = crossings(t, x)
    found = [measure(t, x, a, b, noise) for a, b in itertools.pairwise(c)]
    assert not [h.fault for h in found if h.fault]
    return sum(h.area_before for h in found) / sum(h.area_after for h in found)


def published_form(h):
    """Analytic: R of a square wave through a first-order lag, written down here from the integral."""
    a = math.tanh(h / 2)
    return (h - math.log(1 + a) - a) / (a - math.log(1 + a))


@pytest.mark.parametrize("phase", np.linspace(0, 0.04, 9))
@pytest.mark.parametrize("per_period", [50, 137, 400])
def test_sine_has_ratio_one(wave, phase, per_period):
    t = np.arange(20 * per_period) * 50.0 / per_period
    assert ratio(t, wave("sine", t, phase=phase)) == pytest.approx(1.0, rel=0.005)  # analytic


def test_triangle_has_ratio_one(wave):
    t = np.arange(0.0, 1000.0)
    assert ratio(t, wave("triangle", t, phase=0.013)) == pytest.approx(1.0, rel=1e-6)  # analytic


@pytest.mark.parametrize("period", [50.0, 50.15, 50.37])
def test_exponential_wave_meets_the_closed_form(wave, period):
    t = np.arange(0.0, 1000.0)
    # analytic; the corner lies anywhere between two samples, only 5 samples fall from peak to zero
    assert ratio(t, wave("exponential", t, period)) == pytest.approx(published_form(period / 16), rel=0.02)


@pytest.mark.parametrize("kind, expected", [("sine", 1.0), ("triangle", 1.0), ("exponential", published_form(25 / 8))])
def test_uneven_sampling_changes_little(wave, kind, expected):
    t = np.cumsum(np.random.default_rng(3).uniform(0.3, 1.7, 2000))
    assert ratio(t, wave(kind, t)) == pytest.approx(expected, rel=0.02)  # analytic


def test_crossing_is_interpolated():
    assert crossings(np.array([0.0, 2.0]), np.array([-1.0, 3.0])).tolist() == [0.5]  # analytic


def test_exact_zeros_cross_once():
    t = np.arange(7.0)
    assert len(crossings(t, np.array([-1.0, 0, 0, 0, 1, 1, -1]))) == 2


def test_band_hides_chatter():
    t = np.arange(8.0)
    x = np.array([-2.0, -1, 0.1, -0.1, 0.1, 1, 2, 2])
    assert len(crossings(t, x)) == 3
    once = crossings(t, x, band=0.5)
    assert len(once) == 1
    # analytic: first crossing at 1 + 1/1.1, last at 3.5; their middle is taken
    assert once[0] == pytest.approx(0.5 * (1 + 1 / 1.1 + 3.5))


def test_square_top_is_called_flat(wave):
    t = np.arange(0.0, 200.0) + 0.5
    c = crossings(t, wave("square", t))
    assert {measure(t, wave("square", t), a, b).fault for a, b in itertools.pairwise(c)} == {"flat"}


def test_two_peaks_are_refused():
    t = np.arange(0.0, 21.0)
    x = np.sin(np.pi * t / 20) * (1 + np.cos(4 * np.pi * t / 20 + np.pi) * 0.9)
    assert measure(t, x, 0.0, 20.0).fault == "two_peaks"


def test_few_samples_are_short():
    t = np.arange(0.0, 6.0)
    assert measure(t, np.sin(np.pi * t / 5), 0.0, 5.0).fault == "short"


def test_plateau_peaks_in_its_middle():
    t = np.arange(0.0, 13.0)
    x = np.array([0, 1, 2, 3, 4, 5, 5, 5, 4, 3, 2, 1, 0.0])
    assert measure(t, x, 0.0, 12.0).peak_time == pytest.approx(6.0)  # analytic


def test_misfit_knows_sine_from_triangle(wave):
    t = np.linspace(0, 25, 60)
    sine = measure(t, wave("sine", t), 0.0, 25.0)
    triangle = measure(t, wave("triangle", t), 0.0, 25.0)
    assert sine.sine_misfit < 0.01 * sine.triangle_misfit
    assert triangle.triangle_misfit < 0.01 * triangle.sine_misfit


@settings(max_examples=40)
@given(
    scale=st.floats(1e-4, 1e4),
    slow=st.floats(1e-3, 1e3),
    later=st.floats(-1e3, 1e3),
    sign=st.sampled_from([-1.0, 1.0]),
)
def test_ratio_ignores_scale_sign_and_time(scale, slow, later, sign):
    t = np.arange(0.0, 300.0)
    u = t / 49.3 % 1.0
    x = np.where(u < 0.5, 1.0, -1.0) * (1 - 1.9 * np.exp(-(u % 0.5) * 6))
    assert ratio(slow * t + later, sign * scale * x) == pytest.approx(ratio(t, x), rel=1e-6)
