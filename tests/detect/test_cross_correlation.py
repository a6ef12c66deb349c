"""Horch's cross-correlation: the closed form for sines, invariances, refusals."""

import math

import numpy as np
import pytest
from stickslip.detect.methods import cross_correlation
from stickslip.detect.methods.cross_correlation import detect, symmetry
from stickslip.logs import LoopRecord


def sines(phi, n=4000, period=50.0, noise=0.0, process="self_regulating"):
    t = np.arange(float(n))
    w = 2 * np.pi / period
    rng = np.random.default_rng(1)
    pv = np.sin(w * t - math.radians(phi)) + noise * rng.normal(size=n)
    return LoopRecord.from_arrays(t, pv=pv, op=50 + np.sin(w * t), sp=0 * t, process=process)


@pytest.mark.parametrize(
    ("phi", "d_tau", "d_rho"),  # analytic: phi / 90 and tan^2(phi / 2), folded about 90 degrees
    [(0, 0, 0), (30, 1 / 3, 0.072), (60, 2 / 3, 1 / 3), (90, 1, 1), (120, 2 / 3, 1 / 3), (180, 0, 0)],
)
def test_two_sines(phi, d_tau, d_rho):
    t = 2 * np.pi * np.arange(20_000) / 200
    found = symmetry(np.sin(t), np.sin(t - math.radians(phi)), 200.0)
    assert found.d_tau == pytest.approx(d_tau, abs=0.02)
    assert found.d_rho == pytest.approx(d_rho, abs=0.03)


@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_words(noise):
    assert detect(sines(85, noise=noise)).verdict == "stiction"
    assert detect(sines(45, noise=noise)).verdict == "inconclusive"
    even = detect(sines(170, noise=noise))
    assert even.verdict == "inconclusive" and "not cleared" in even.reason


def test_unit_offset_sign_and_action_do_not_matter():
    base = sines(80)
    index = detect(base).index
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -1.0), (1e3, -7.0, 0.02)):
        other = LoopRecord.from_arrays(
            base.t, pv=gain * base.pv + offset, op=50 + op_gain * (base.op - 50), sp=0 * base.t + offset,
            process="self_regulating",
        )  # fmt: skip
        assert detect(other).index == pytest.approx(index, abs=1e-6)


def test_refusals():
    assert detect(sines(90, process="integrating")).code == "wrong_process_type"
    assert detect(sines(90, n=220)).code == "too_few_cycles"
    assert detect(sines(90, period=6.0)).code == "undersampled"


def test_picture():
    figure = detect(sines(85)).plot()
    figure.canvas.draw()
    assert "odd" in figure.axes[0].get_title(loc="left")
    assert cross_correlation.CARD.experimental
