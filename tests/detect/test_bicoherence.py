"""Bicoherence, ellipse and clusters: closed forms, twins, refusals, invariances."""

import math

import numpy as np
import pytest
from stickslip.detect.methods import bicoherence as method
from stickslip.detect.methods.bicoherence import CHI2, bicoherence, clusters, detect, ellipse
from stickslip.logs import LoopRecord


def test_gaussian_noise_is_below_its_limit():
    """Analytic: 2 K bic^2 is about chi squared with 2 degrees of freedom: 5 % of the points above c, mean 1 / K."""
    shares = []
    for seed in range(5):
        x = np.random.default_rng(seed).normal(size=64 * 64)
        found = bicoherence(x)
        segments = (len(x) - 64) // 32 + 1
        shares.append(np.mean(found.squared > CHI2 / (2 * segments)))
        assert np.mean(found.squared) < 1 / segments
    assert np.mean(shares) < 0.05


def test_skewed_noise_is_above_it():
    x = np.random.default_rng(0).exponential(size=64 * 64)
    gauss = bicoherence(np.random.default_rng(0).normal(size=64 * 64))
    assert bicoherence(x).ngi > 5 * max(gauss.ngi, 0.001)


@pytest.mark.parametrize("kind", ["square", "triangle"])
def test_symmetric_waves_are_a_blind_spot(wave, loop, kind):
    """Published: odd harmonics only, and no sum of two of them is a third."""
    t = np.arange(6000.0)
    for seed in range(4):
        e = wave(kind, t, 51.3) + 0.1 * np.random.default_rng(seed).normal(size=6000)
        v = detect(loop(t, e))
        assert v.verdict == "inconclusive", v.reason


def test_coupled_lines_stand_where_they_are():
    rng = np.random.default_rng(0)
    a, b = rng.uniform(0, 2 * np.pi, (2, 100, 1))
    t = 2 * np.pi * np.arange(64) / 128
    x = np.cos(24 * t + a) + np.cos(14 * t + b) + np.cos(38 * t + a + b) + 0.1 * rng.normal(size=(100, 64))
    f1, f2 = bicoherence(x.ravel()).peak
    assert (f1 * 128, f2 * 128) == (pytest.approx(24, abs=3), pytest.approx(14, abs=3))


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2, 2.5])
@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_ellipse_of_known_axes(angle, noise):
    """Analytic: axes 3 and 1, turned; the chord is 2 m n / sqrt(m^2 sin^2 + n^2 cos^2)."""
    rng = np.random.default_rng(0)
    a = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    x, y = 3 * np.cos(a), np.sin(a)
    x, y = x * math.cos(angle) - y * math.sin(angle) + 5, x * math.sin(angle) + y * math.cos(angle) - 2
    found = ellipse(x + noise * rng.normal(size=400), y + noise * rng.normal(size=400))
    assert (found.m, found.n) == (pytest.approx(3, rel=0.03), pytest.approx(1, rel=0.03))
    assert found.centre == (pytest.approx(5, abs=0.03), pytest.approx(-2, abs=0.03))
    assert found.chord == pytest.approx(6 / math.sqrt(9 * math.sin(angle) ** 2 + math.cos(angle) ** 2), rel=0.03)
    assert found.fit > 0.95


def test_no_ellipse_through_a_line():
    x = np.linspace(-1, 1, 200)
    found = ellipse(x, 2 * x + 1e-9 * np.random.default_rng(0).normal(size=200))
    assert found is None or found.chord < 0.01 or found.fit < 0.8


def test_clusters_of_a_parallelogram():
    """Analytic: two level sides at OP = -2 and 2, joined by steps of PV."""
    pv = np.concatenate([np.linspace(-1, 1, 100), np.ones(20), np.linspace(1, -1, 100), -np.ones(20)])
    op = np.concatenate([np.full(100, -2.0), np.linspace(-2, 2, 20), np.full(100, 2.0), np.linspace(2, -2, 20)])
    assert clusters(op, pv) == (pytest.approx(-2), pytest.approx(2))


def test_linear_loops_are_seldom_accused(forced, wave, loop):
    """Measured: 1 of 40 loops under an outside sine, none of 40 noisy sines (docstring of the module)."""
    t = np.arange(6000.0)
    records = [forced(n=6000, seed=seed) for seed in range(10)]
    records += [
        loop(t, wave("sine", t, 53.0) + 0.3 * np.random.default_rng(seed).normal(size=6000)) for seed in range(10)
    ]
    words = [detect(record).verdict for record in records]
    assert words.count("stiction") <= 2
    assert "no_stiction" not in words


def test_offset_scale_sign_and_action(sticky):
    base = sticky(noise=0.02, n=6000, walk=0.01, R=10.0)
    first = detect(base)
    assert first.verdict == "stiction"
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -1.0), (1e3, -7.0, 0.5)):
        pv, op, sp = gain * base.pv + offset, 50 + op_gain * (base.op - 50), gain * base.sp + offset
        v = detect(LoopRecord.from_arrays(base.t, pv=pv, op=op, sp=sp, process="self_regulating"))
        assert v.index == pytest.approx(first.index, rel=1e-6)
        assert v.amount_percent_op == pytest.approx(abs(op_gain) * first.amount_percent_op, rel=1e-6)


def test_refusals(sticky, wave, loop):
    t = np.arange(700.0)
    assert detect(loop(t, wave("exponential", t, 50.0))).code == "too_few_cycles"
    assert detect(sticky("integrating")).code == "wrong_process_type"


def test_picture(sticky):
    figure = detect(sticky(noise=0.02, n=6000, walk=0.01, R=10.0)).plot()
    figure.canvas.draw()
    assert "twins" in figure.axes[1].get_xlabel()
    assert method.CARD.experimental
