"""Relay fit: values of the continuum, the two ends of the relay wave, invariances, refusals."""

import numpy as np
import pytest
from stickslip.detect.half_waves.half_wave_fits import gather
from stickslip.detect.half_waves.waves import HalfWave
from stickslip.detect.methods import relay_fit
from stickslip.detect.methods.relay_fit import Params, detect, errors
from stickslip.logs import LoopRecord

from .conftest import own_turns


def continuum(shape, m=20_000):
    x = (np.arange(m) + 0.5) / m
    y = np.concatenate([[0.0], shape(x), [0.0]])
    return errors(gather([HalfWave(0, np.concatenate([[0.0], x, [1.0]]), y, 1.0, 1.0)])).S_I


def exponential(x, h=25 / 8):
    """Square wave behind a lag, from its crossing on, h = (half period) / tau."""
    a = np.tanh(h / 2)
    zero = np.log1p(a) / h
    s = x + zero
    return np.where(s < 1, 1 - (1 + a) * np.exp(-h * s), -1 + (1 + a) * np.exp(-h * (s - 1)))


def test_values_of_the_continuum():
    """Golden values of the design notes, section 6; sine and triangle are analytic."""
    assert continuum(lambda x: np.sin(np.pi * x)) == pytest.approx(-1.0, abs=1e-6)
    assert continuum(lambda x: 1 - np.abs(2 * x - 1)) == pytest.approx(1.0, abs=1e-6)
    assert continuum(np.ones_like) == pytest.approx(0.769, abs=0.001)
    assert continuum(lambda x: np.where(x < 0.9, x / 0.9, 10 * (1 - x))) == pytest.approx(0.406, abs=0.001)
    assert continuum(exponential) > 0.97  # analytic: 1, less what the grid of 25 ratios leaves


def test_the_square_by_integrals():
    """Analytic: E_S = 1 - 8 / pi^2; E_R by the integrals of the wave with q = 30."""
    g = 1 / (30 + np.log(2))
    one, two = 1 - 2 * g * np.log(2), 0.0  # integral of the wave: T - 2 g ln 2 up to exp(-30)
    two = 1 - 2 * g  # of its square: rise 30 g - 2 g + g / 2; fall 4 g (1 - 1/4) / 2 - 4 g (1 - 1/2) + g ln 2
    two = (30 * g - 1.5 * g) + (1.5 * g - 2 * g + g * np.log(2))
    E_R, E_S = 1 - one**2 / two, 1 - 8 / np.pi**2
    assert continuum(np.ones_like) == pytest.approx((E_S - E_R) / (E_S + E_R), abs=1e-4)


def of(shape, n=3000, period=60.0, noise=0.0, gain=1.0, offset=0.0, dt=1.0, op_gain=-1.0, process="self_regulating"):
    t = dt * np.arange(n / dt)
    u = (own_turns(t, period) + 0.013) % 1
    y = np.where(u < 0.5, 1, -1) * shape(2 * (u % 0.5)) + noise * np.random.default_rng(1).normal(size=len(t))
    op = 50 - op_gain * np.cos(2 * np.pi * u)
    return LoopRecord.from_arrays(t, pv=gain * y + offset, op=op, sp=0 * t + offset, process=process)


@pytest.mark.parametrize("noise", [0.01, 0.2])
def test_words(noise):
    assert detect(of(exponential, noise=noise)).verdict == "stiction"
    assert detect(of(lambda x: 1 - np.abs(2 * x - 1), noise=noise)).verdict == "stiction"
    sine = detect(of(lambda x: np.sin(np.pi * x), noise=noise))
    assert sine.verdict == "inconclusive" and "not cleared" in sine.reason


def test_the_interval_holds_the_index():
    v = detect(of(exponential, noise=0.3))
    assert v.interval is not None and v.interval[0] < v.index < v.interval[1]


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of(exponential)).index
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -4.0), (1e3, -7.0, 0.02)):
        assert detect(of(exponential, gain=gain, offset=offset, op_gain=op_gain)).index == pytest.approx(base, abs=1e-6)
    assert detect(of(exponential, dt=0.5)).index == pytest.approx(base, abs=0.03)


def test_refusals():
    assert detect(of(exponential, n=150, noise=0.01)).code in ("no_oscillation", "too_few_cycles")
    assert detect(of(exponential), Params(half_waves_min=1000)).code == "too_few_cycles"
    assert detect(of(exponential, period=8.0, noise=0.05)).code == "undersampled"


def test_picture():
    figure = detect(of(exponential, noise=0.1)).plot()
    figure.canvas.draw()
    assert [line.get_label() for line in figure.axes[0].lines[-2:]] == ["sine", "relay wave"]
    assert relay_fit.CARD.experimental
