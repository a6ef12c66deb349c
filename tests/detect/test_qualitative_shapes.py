"""Qualitative shapes: words for plain waves, which signal decides, invariances, refusals."""

import numpy as np
import pytest
from stickslip.detect.methods.qualitative_shapes import detect
from stickslip.logs import LoopRecord


def shape(kind, u, apex=0.5):
    u = u % 1.0
    if kind == "triangle":
        up = apex / 2
        return np.interp(u, [0, up, 1 - (0.5 - up) - 0.0, 1], [0, 1, -1, 0])
    return np.sin(2 * np.pi * u)


def of(kind, n=3000, period=60.0, noise=0.05, gain=1.0, offset=50.0, other=1.0, dt=1.0, process="self_regulating",
       apex=0.5):  # fmt: skip
    """OP of this shape and PV a sine; the other way round with an integrating process."""
    t = dt * np.arange(n / dt)
    u = t / period + 0.013
    wave = gain * (shape(kind, u, apex) + noise * np.random.default_rng(1).normal(size=len(t))) + offset
    smooth = other * np.cos(2 * np.pi * u)
    if process == "integrating":
        return LoopRecord.from_arrays(t, pv=wave, op=50 + smooth, sp=0 * t + offset, process=process)
    return LoopRecord.from_arrays(t, pv=smooth, op=wave, sp=0 * t, process=process)


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_words(process, noise):
    for apex in (0.5, 0.3):
        assert detect(of("triangle", noise=noise, process=process, apex=apex)).verdict == "stiction"
    sine = detect(of("sine", noise=noise, process=process))
    assert sine.verdict == "inconclusive" and "not cleared" in sine.reason and "D G E B" in sine.reason


def test_much_noise_decides_nothing():
    v = detect(of("triangle", noise=0.6))
    assert v.verdict == "inconclusive" and "noise" in v.reason


def test_few_samples_are_not_made_straight_by_joining_them():
    assert detect(of("sine", period=23.0, noise=0.0)).index == 0.0


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of("triangle", noise=0.1)).index
    for gain, offset, other in ((-1.0, 40.0, 3.0), (0.1, 60.0, -2.0), (3.0, 47.0, 1e3)):
        assert detect(of("triangle", noise=0.1, gain=gain, offset=offset, other=other)).index == pytest.approx(
            base, abs=0.15
        )  # turned over, other cycles are cut
    assert detect(of("triangle", noise=0.1, dt=0.5)).index == pytest.approx(base, abs=0.15)


def test_refusals():
    assert detect(of("triangle", process="unknown")).code == "integrating_unknown"
    assert detect(of("triangle", period=12.0)).code == "undersampled"


def test_picture():
    figure = detect(of("triangle")).plot()
    figure.canvas.draw()
    assert {text.get_text() for text in figure.axes[0].texts} >= {"C", "F"}
