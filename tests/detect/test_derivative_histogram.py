"""Histogram of the derivative: densities, how the noise passes the filter, which derivative, the cut."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt
from stickslip.detect.methods.derivative_histogram import EDGES, Params, bell_or_humps, detect, noise_share
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord


def test_the_humps_are_the_density_of_a_sine():
    """Analytic: arcsine law for amplitude sqrt(2), whose variance is 1."""
    found = bell_or_humps(np.sin(2 * np.pi * (np.arange(100_000) + 0.5) / 100_000))
    assert found.q < 0.05 and found.amplitude == pytest.approx(np.sqrt(2), abs=0.03)
    law = lambda x: np.arcsin(np.clip(x / np.sqrt(2), -1, 1)) / np.pi  # noqa: E731
    assert found.density == pytest.approx(np.diff(law(EDGES)) / 0.2, abs=0.01)


def test_the_bell_is_gaussian():
    found = bell_or_humps(np.random.default_rng(1).normal(3.0, 7.0, 100_000))
    x = 0.5 * (EDGES[1:] + EDGES[:-1])
    assert found.q > 0.95
    assert found.bell == pytest.approx(np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), abs=0.02)  # analytic


@pytest.mark.parametrize("order", [1, 2])
def test_noise_share_is_that_of_filtered_noise(order):
    """Against white noise that runs through the same filter and differences."""
    t = np.arange(18_000.0)
    noise = np.random.default_rng(2).normal(size=len(t))
    clean = 5 * np.sin(2 * np.pi * t / 60)
    loop = Prepared(LoopRecord.from_arrays(t, pv=clean + noise, op=50 + clean, sp=0 * t))
    y = sosfiltfilt(butter(2, 2 * 3 / 60, output="sos"), noise)
    for _ in range(order):
        y = np.gradient(y)
    assert noise_share(loop, 3.0, order, 1.0) == pytest.approx(np.var(y[100:-100]), rel=0.15)


def of(kind, n=4000, period=60.0, noise=0.01, gain=1.0, offset=0.0, op_gain=1.0, dt=1.0, process="self_regulating"):
    t = dt * np.arange(n / dt)
    u = (t / period + 0.013) % 1
    y = {"square": np.tanh(9 * np.sin(2 * np.pi * u)), "triangle": 1 - 4 * np.abs((u + 0.25) % 1 - 0.5),
         "sine": np.sin(2 * np.pi * u)}[kind]  # fmt: skip
    y = y + noise * np.random.default_rng(1).normal(size=len(t))
    op = 50 + op_gain * np.cos(2 * np.pi * u)
    return LoopRecord.from_arrays(t, pv=gain * y + offset, op=op, sp=0 * t + offset, process=process)


@pytest.mark.parametrize("cut", [3.0, 6.0])
def test_words(cut):
    p = Params(cut=cut)
    assert detect(of("square"), p).verdict == "stiction"
    assert detect(of("triangle", process="integrating"), p).verdict == "stiction"
    for process in ("self_regulating", "integrating"):
        sine = detect(of("sine", process=process), p)
        assert sine.verdict == "inconclusive" and "not cleared" in sine.reason
    # the wrong derivative sees the wrong wave: that of a triangle is a square, neither bell nor spikes
    assert detect(of("triangle"), p).verdict == "inconclusive"


def test_a_wider_cut_sees_more():
    assert detect(of("square"), Params(cut=6.0)).index > detect(of("square")).index + 0.2


def test_noise_accuses_nobody():
    v = detect(of("sine", noise=0.6, process="integrating"), Params(cut=6.0))
    assert v.verdict == "inconclusive" and "noise makes" in v.reason


def test_a_wave_that_swells_and_fades_is_no_bell():
    """A resonance driven by noise: without evening out, its derivative is Gaussian, as its closed form says."""
    pole = np.exp((-0.05 + 1j * np.sqrt(1 - 0.05**2)) * 2 * np.pi / 60)
    w = np.random.default_rng(3).normal(size=6000)
    e = lfilter([1], [1, -2 * pole.real, abs(pole) ** 2], w)[2000:]
    e = e / e.std() + 0.005 * np.random.default_rng(4).normal(size=4000)
    loop = LoopRecord.from_arrays(np.arange(4000.0), pv=e, op=50 - e, sp=0 * e, process="self_regulating")
    assert detect(loop, Params(even_out=False)).index > 0.5
    assert detect(loop).index < 0.4


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of("square")).index
    for gain, offset, op_gain in ((-3.0, 40.0, -1.0), (0.1, 0.0, 4.0), (1e3, -7.0, 0.02)):
        other = detect(of("square", gain=gain, offset=offset, op_gain=op_gain)).index
        assert other == pytest.approx(base, abs=0.02)  # a sample at the edge of a bin may change sides
    assert detect(of("square", dt=0.5)).index == pytest.approx(base, abs=0.05)


def test_refusals():
    assert detect(of("square", process="unknown")).code == "integrating_unknown"
    assert detect(of("square", period=8.0)).code == "undersampled"
    with pytest.raises(ValueError, match="give more than 1"):
        Params(cut=0.5)


def test_picture():
    figure = detect(of("square")).plot()
    figure.canvas.draw()
    assert figure.axes[0].get_legend_handles_labels()[1] == ["bell", "humps of a sine"]
