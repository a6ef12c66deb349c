"""The Harris index: closed forms of AR and MA processes, and a loop at minimum variance."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect import diagnose
from stickslip.detect.signals.harris import harris


def noise(n=20_000, seed=0):
    return np.random.default_rng(seed).normal(size=n)


@pytest.mark.parametrize("a", [0.5, 0.9, -0.7])
@pytest.mark.parametrize("horizon", [1, 3, 10])
def test_first_order_process(a, horizon):
    """Analytic: psi(i) = a^i, so that eta = 1 - a^(2 d)."""
    found = harris(lfilter([1], [1, -a], noise()), horizon)
    assert found.eta == pytest.approx(1 - a ** (2 * horizon), abs=0.03)
    assert found.index == 1 - found.eta


@pytest.mark.parametrize("horizon", [1, 2, 3, 4])
def test_moving_average(horizon):
    """Analytic: psi = 1, 0.8, 0.4 and then nothing: at minimum variance from d = 3 on."""
    psi = np.array([1.0, 0.8, 0.4])
    found = harris(lfilter(psi, [1], noise()), horizon)
    assert found.eta == pytest.approx(np.sum(psi[:horizon] ** 2) / np.sum(psi**2), abs=0.03)


@pytest.mark.parametrize("zeta", [0.05, 0.3])
def test_a_mode_of_known_damping(zeta):
    """Analytic: psi of two complex poles p: r^i sin((i + 1) w) / sin(w)."""
    w = 2 * math.pi / 40
    r = math.exp(-zeta * w)
    y = lfilter([1], [1, -2 * r * math.cos(w), r * r], noise(40_000))
    psi = r ** np.arange(4000.0) * np.sin((np.arange(4000.0) + 1) * w) / math.sin(w)
    assert harris(y, 5).eta == pytest.approx(np.sum(psi[:5] ** 2) / np.sum(psi**2), rel=0.1)


def test_a_minimum_variance_controller_reaches_one():
    """A process of pure delay 3 under integrated noise; u takes back what is foretold: y is MA(2), eta = 1 at d = 3."""
    d, e = 3, noise(20_000, 1)
    load = np.cumsum(e)
    y, u = np.zeros(20_000), np.zeros(20_000)
    for t in range(d, 20_000):
        y[t] = load[t] + u[t - d]
        u[t] = -load[t]
    assert harris(y[10:], d).eta == pytest.approx(1.0, abs=0.01)
    assert harris(y[10:], 1).eta == pytest.approx(1 / 3, abs=0.05)  # its zeros lie on the unit circle


def test_scale_offset_and_sign_do_not_matter():
    y = lfilter([1], [1, -0.8], noise(3000))
    assert harris(-30 * y + 7, 2).eta == pytest.approx(harris(y, 2).eta)


def test_an_oscillation_is_foretold(wave):
    y = wave("sine", np.arange(2000.0)) + 0.05 * noise(2000)
    assert harris(y, 5).eta < 0.1


@pytest.mark.parametrize("y", [np.zeros(100), np.ones(5), np.arange(3.0), np.full(100, np.nan)], ids=str)
def test_nothing_to_judge(y):
    assert harris(y, 2) is None


def test_no_horizon_is_refused():
    with pytest.raises(ValueError, match="1 or more"):
        harris(noise(100), 0)


def test_a_diagnosis_says_it(sticky, loop):
    found = diagnose(sticky(noise=0.05))
    assert 0.0 < found.performance.eta < 0.6
    flat = diagnose(loop(np.arange(100.0), np.zeros(100)))
    assert flat.performance is None
