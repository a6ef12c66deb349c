"""What is left of PV: its line, its memory and its spread, against closed forms."""

import numpy as np
import pytest
from stickslip.remedy.left import free_of_line, nugget, paced, past, size, wandering, whitened


def wander(n=20_000, a=0.8):
    e = np.random.default_rng(1).normal(size=n)
    v = np.zeros(n)
    for k in range(1, n):
        v[k] = a * v[k - 1] + e[k]
    return v, e


def test_a_memory_is_that_of_least_squares():
    v, _ = wander(500)
    spans = [(1, 1), (2, 2), (3, 3), (4, 5), (6, 8), (9, 13), (14, 21), (22, 33)]
    a = past(v)
    X = np.column_stack([np.mean([v[33 - k : len(v) - k] for k in range(i, j + 1)], axis=0) for i, j in spans])
    b = np.linalg.lstsq(X, v[33:], rcond=None)[0]
    np.testing.assert_allclose(
        a, np.concatenate([[c / (j - i + 1)] * (j - i + 1) for c, (i, j) in zip(b, spans, strict=True)]), atol=1e-6
    )
    assert len(past(v[:60])) == 5  # a short record has a short memory


def test_whitened_it_is_what_made_it():
    v, e = wander(500)
    np.testing.assert_allclose(whitened(v, np.array([0.8])), e[1:], atol=1e-12)  # analytic
    assert past(wander()[0])[0] == pytest.approx(0.8, abs=0.03)


@pytest.mark.parametrize("roots", [1, 2])
def test_what_wanders_has_its_roots_at_1(roots):
    a = wandering(wander()[0].cumsum(), roots)
    # analytic: 1 - sum a_k z^-k is 0 at z = 1, and so is its slope where the root is double
    assert np.sum(a) == pytest.approx(1.0)
    assert (float(np.arange(1, len(a) + 1) @ a) == pytest.approx(0.0, abs=1e-6)) == (roots == 2)


def test_a_line_goes_and_outliers_count_less():
    v, (level, slope) = free_of_line(3.0 + 0.5 * np.arange(100.0))
    np.testing.assert_allclose([level, slope, np.abs(v).max()], [3.0, 0.5, 0.0], atol=1e-12)
    e = np.random.default_rng(2).normal(size=1000)
    assert size(np.append(e, 1e6)) < 1.2 * size(e)


@pytest.mark.parametrize("smooth", [False, True])
def test_the_noise_beside_a_load_lies_within_its_interval(smooth):
    load = wander(6_000, 0.98)[0]
    load = 0.05 * np.convolve(load, np.ones(20), "same") if smooth else load
    low, value, high = nugget(load + 2.0 * np.random.default_rng(7).normal(size=6_000))
    assert low < 4.0 < high and value == pytest.approx(4.0, rel=0.15)
    assert nugget(load)[0] < 0.05 and nugget(load)[2] < 0.8  # none


def test_a_load_at_a_steady_pace_tells_itself_and_a_wander_does_not():
    rng, t = np.random.default_rng(5), np.arange(3000)
    triangle = 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * t / 121.3))
    assert paced(triangle + 0.02 * rng.normal(size=3000)) > 100.0
    assert paced(wander()[0]) < 10.0
    assert paced(np.arange(3000.0)) == 0.0  # no wave
