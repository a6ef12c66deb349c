"""Third harmonics: Fourier series of the waves, invariances, abstention."""

import numpy as np
import pytest
from stickslip.detect.methods.harmonics import amplitudes, detect, harmonics_of
from stickslip.logs import LoopRecord


def shape(kind, u):
    u = u % 1.0
    if kind == "square":
        return np.where(u < 0.5, 1.0, -1.0)
    if kind == "triangle":
        return 1 - 4 * np.abs((u + 0.25) % 1.0 - 0.5)
    return np.sin(2 * np.pi * u)


@pytest.mark.parametrize(("kind", "h3", "c3"), [("triangle", 1 / 9, 1.0), ("square", 1 / 3, -1.0)])
@pytest.mark.parametrize("start", [0.0, 0.2, 0.71])
def test_fourier_series(kind, h3, c3, start):
    """Analytic: third over first coefficient, and their phases, wherever the block starts."""
    for period in (50.0, 53.7):  # the search starts from 50
        (a,) = amplitudes((shape(kind, start + np.arange(2000) / period),), 200, 50.0)
        found = harmonics_of(a)
        assert found.h3 == pytest.approx(h3, rel=0.05)
        assert found.c3 == pytest.approx(c3, abs=0.02)
        assert found.h2 < 0.03


def test_a_sine_has_none():
    (a,) = amplitudes((np.sin(np.arange(2000) / 8),), 200, 50.0)
    assert harmonics_of(a).h3 < 1e-3


def of(op="triangle", pv="square", n=3000, period=60.0, noise=0.05, gain=1.0, offset=0.0, op_gain=1.0, dt=1.0,
       process="self_regulating"):  # fmt: skip
    t = dt * np.arange(n / dt)
    rng = np.random.default_rng(2)
    u = t / period
    return LoopRecord.from_arrays(
        t, pv=gain * (shape(pv, u) + noise * rng.normal(size=len(t))) + offset,
        op=50 + op_gain * (shape(op, u + 0.25) + noise * rng.normal(size=len(t))), sp=0 * t + offset, process=process,
    )  # fmt: skip


@pytest.mark.parametrize("noise", [0.02, 0.3])
def test_words(noise):
    assert detect(of(noise=noise)).verdict == "stiction"
    assert detect(of("sine", "sine", noise=noise)).verdict == "inconclusive"
    assert detect(of("triangle", "sine", noise=noise)).verdict == "inconclusive"
    assert detect(of("square", "triangle", noise=noise)).verdict == "inconclusive"
    assert detect(of("sine", "triangle", noise=noise, process="integrating")).verdict == "stiction"
    assert detect(of("sine", "square", noise=noise, process="integrating")).verdict == "inconclusive"
    more = detect(of("square", "triangle", noise=noise, process="integrating"))
    assert more.verdict == "stiction"  # a square is no triangle


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of()).index
    for gain, offset, op_gain in ((-3.0, 40.0, -1.0), (0.1, 0.0, 4.0), (1e3, -7.0, 0.02)):
        assert detect(of(gain=gain, offset=offset, op_gain=op_gain)).index == pytest.approx(base, abs=1e-6)
    assert detect(of(dt=0.5)).index == pytest.approx(base, abs=0.02)


def test_unequal_halves_are_left_alone():
    t = np.arange(3000.0)
    u = (t / 60) % 1
    pulse, ramp = np.where(u < 0.3, 1.0, 0.0), np.where(u < 0.3, u / 0.3, (1 - u) / 0.7)
    noise = 0.02 * np.random.default_rng(0).normal(size=3000)
    v = detect(LoopRecord.from_arrays(t, pv=pulse + noise, op=50 + ramp, sp=0 * t, process="self_regulating"))
    assert v.verdict == "inconclusive" and "unequal" in v.reason


def test_refusals():
    assert detect(of(process="unknown")).code == "integrating_unknown"
    assert detect(of(n=400)).code == "too_few_cycles"
    assert detect(of(period=8.0)).code == "undersampled"


def test_picture():
    figure = detect(of()).plot()
    figure.canvas.draw()
    assert figure.axes[0].get_legend_handles_labels()[1] == ["OP", "PV"]
