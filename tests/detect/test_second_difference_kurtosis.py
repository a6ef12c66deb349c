"""Kurtosis of the second difference: closed forms of a sine, noise and a filtered triangle; levels; invariances."""

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt
from stickslip.detect.methods.second_difference_kurtosis import detect, excess, noise_share
from stickslip.detect.prepare.prepared import CUT
from stickslip.logs import LoopRecord


def level(wave, kind, noise=0.0, n=4000, period=100.0):
    t = np.arange(float(n))
    pv = 50 + 5 * wave(kind, t, period) + noise * np.random.default_rng(1).normal(size=n)
    op = 50 + wave("sine", t, period, 0.25)
    return LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t + 50, process="integrating")


def test_sine_and_noise():  # analytic: -3/2 and 0
    assert excess(np.diff(np.sin(2 * np.pi * np.arange(10_000) / 100), 2)) == pytest.approx(-1.5, abs=1e-3)
    assert excess(np.random.default_rng(0).normal(size=100_000)) == pytest.approx(0.0, abs=0.1)


def test_triangle_through_the_filter(wave):
    # analytic: the second derivative of a triangle has equal odd harmonics, which the filter weighs 1 / (1 + (k/5)^4)
    theta = 2 * np.pi * np.arange(10_000) / 10_000
    d = sum(np.cos(k * theta) / (1 + (k / CUT) ** 4) for k in range(1, 100, 2))
    assert excess(d) == pytest.approx(2.06, abs=0.01)
    v = detect(level(wave, "triangle", noise=0.01))
    assert v.verdict == "stiction"
    assert v.index == pytest.approx(excess(d), abs=0.1)
    assert v.interval[0] <= v.index <= v.interval[1]


def test_share_of_noise():  # the closed form against filtered noise
    noise = np.random.default_rng(0).normal(size=200_000)
    d = np.diff(sosfiltfilt(butter(2, 2 * CUT / 500, output="sos"), noise), 2)
    assert noise_share(d, 1.0, 500.0) == pytest.approx(1.0, abs=0.06)


def test_words(wave):
    sine = detect(level(wave, "sine", noise=0.01))
    assert sine.verdict == "inconclusive" and "nothing is cleared" in sine.reason
    loud = detect(level(wave, "triangle", noise=2.0))
    assert loud.verdict == "inconclusive" and "noise" in loud.reason


@pytest.mark.parametrize(("valve", "word"), [("kano", "stiction"), ("choudhury", "stiction"), ("he", "inconclusive")])
def test_valves(
    valve, word, simulated
):  # snapshot: the valve of He slips several times a stroke and rounds the corners
    v = detect(simulated(valve, "integrating", S=6.0, J=4.0, n=4000))
    assert v.verdict == word, v.reason


def test_unit_sign_action_and_sampling_do_not_matter(sticky, bare):
    base = sticky("integrating", noise=0.02, n=6000)
    first = detect(base).index
    for change in ({"gain": -3.0, "offset": 40.0}, {"op_gain": -1.0}, {"op_gain": 0.16}):
        assert detect(bare(base, **change)).index == pytest.approx(first, rel=1e-6)
    assert detect(bare(base, every=2)).index == pytest.approx(first, abs=0.15)


def test_refusals_and_picture(sticky, wave):
    assert detect(sticky(noise=0.1)).code == "wrong_process_type"
    record = level(wave, "triangle", noise=0.01)
    unknown = LoopRecord.from_arrays(record.t, pv=record.pv, op=record.op, sp=record.sp)
    assert detect(unknown).code == "integrating_unknown"
    figure = detect(record).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 3
