"""Curve fit: values of the continuum, which signal is read, invariances, refusals."""

import numpy as np
import pytest
from stickslip.detect.half_waves.half_wave_fits import gather
from stickslip.detect.half_waves.waves import HalfWave
from stickslip.detect.methods import curve_fit
from stickslip.detect.methods.curve_fit import Params, detect, errors
from stickslip.logs import LoopRecord

from .conftest import own_turns


def continuum(shape, m=4000):
    x = (np.arange(m) + 0.5) / m
    y = np.concatenate([[0.0], shape(x), [0.0]])
    return errors(gather([HalfWave(0, np.concatenate([[0.0], x, [1.0]]), y, 1.0, 1.0)])).SI


def bent(x, apex):
    return np.minimum(x / apex, (1 - x) / (1 - apex))


def exponential(x, h=25 / 8):
    a = np.tanh(h / 2)
    s = x + np.log1p(a) / h
    return np.where(s < 1, 1 - (1 + a) * np.exp(-h * s), -1 + (1 + a) * np.exp(-h * (s - 1)))


def test_values_of_the_continuum():
    """Sine, triangle and square are analytic; the exponential wave is a golden value of the notes, section 6."""
    assert continuum(lambda x: np.sin(np.pi * x)) == pytest.approx(0.0, abs=1e-9)
    for apex in (0.5, 0.9, 0.1):
        assert continuum(lambda x, a=apex: bent(x, a)) == pytest.approx(1.0, abs=1e-3)
    E_sine, E_triangle = 1 - 8 / np.pi**2, 1 / 4  # of a square: every apex has the same integrals 1/2 and 1/3
    assert continuum(np.ones_like) == pytest.approx(E_sine / (E_sine + E_triangle), abs=1e-3)
    assert continuum(exponential) == pytest.approx(0.63, abs=0.005)


def of(shape, n=3000, period=60.0, noise=0.01, gain=1.0, offset=50.0, dt=1.0, pv_gain=1.0, process="self_regulating"):
    """OP of this shape and PV a sine; the other way round with an integrating process."""
    t = dt * np.arange(n / dt)
    u = (own_turns(t, period) + 0.013) % 1
    wave = np.where(u < 0.5, 1, -1) * shape(2 * (u % 0.5))
    wave = gain * (wave + noise * np.random.default_rng(1).normal(size=len(t))) + offset
    smooth = pv_gain * np.cos(2 * np.pi * u)
    if process == "integrating":
        return LoopRecord.from_arrays(t, pv=wave, op=50 + smooth, sp=0 * t + offset, process=process)
    return LoopRecord.from_arrays(t, pv=smooth, op=wave, sp=0 * t, process=process)


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
@pytest.mark.parametrize("noise", [0.01, 0.2])
@pytest.mark.parametrize("apex", [0.5, 0.8])
def test_words(process, noise, apex):
    assert detect(of(lambda x: bent(x, apex), noise=noise, process=process)).verdict == "stiction"
    sine = detect(of(lambda x: np.sin(np.pi * x), noise=noise, process=process))
    assert sine.verdict == "inconclusive" and "not cleared" in sine.reason


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_the_other_signal_is_not_read(process):
    """OP of a self-regulating loop is a triangle, and PV too: only the first decides, and the other way round."""
    v = detect(of(lambda x: bent(x, 0.5), process=process))
    assert ("half waves of PV" if process == "integrating" else "half waves of OP") in v.reason


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    shape = lambda x: bent(x, 0.7)  # noqa: E731
    base = detect(of(shape)).index
    for gain, offset, pv_gain in ((-1.0, 40.0, 3.0), (0.1, 60.0, -2.0), (3.0, 47.0, 1e3)):
        assert detect(of(shape, gain=gain, offset=offset, pv_gain=pv_gain)).index == pytest.approx(base, abs=1e-6)
    assert detect(of(shape, dt=0.5)).index == pytest.approx(base, abs=0.03)


def test_refusals():
    shape = lambda x: bent(x, 0.5)  # noqa: E731
    assert detect(of(shape, process="unknown")).code == "integrating_unknown"
    assert detect(of(shape), Params(half_waves_min=1000)).code == "too_few_cycles"
    assert detect(of(shape, period=8.0)).code == "undersampled"


def test_picture():
    figure = detect(of(lambda x: bent(x, 0.6), noise=0.1)).plot()
    figure.canvas.draw()
    assert [line.get_label() for line in figure.axes[0].lines[-2:]] == ["sine", "triangle"]
    assert curve_fit.CARD.experimental
