"""Templates by time warping: the distance against a plain double loop, names of waves, invariances, refusals."""

import numpy as np
import pytest
from stickslip.detect.methods.dtw_shapes import Params, detect, distances, named, templates
from stickslip.logs import LoopRecord


def plain(x, y, band):
    """Sakoe and Chiba's symmetric path, written as their recursion."""
    n = len(x)
    g = np.full((n, n), np.inf)
    for i in range(n):
        for j in range(max(0, i - band), min(n, i + band + 1)):
            d = abs(x[i] - y[j])
            before = [2 * d] if i == j == 0 else []
            before += [g[i - 1, j] + d] if i else []
            before += [g[i, j - 1] + d] if j else []
            before += [g[i - 1, j - 1] + 2 * d] if i and j else []
            g[i, j] = min(before)
    return g[-1, -1] / (2 * n)


@pytest.mark.parametrize("band", [0, 1, 3, 6])
def test_the_distance_is_that_of_the_recursion(band):
    rng = np.random.default_rng(band)
    x, y = rng.normal(size=(3, 24)), rng.normal(size=(4, 24))
    expected = [[plain(a, b, band) for b in y] for a in x]
    assert distances(x, y, band) == pytest.approx(np.array(expected))


def test_without_warping_it_is_the_mean_distance():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(1, 64)), rng.normal(size=(1, 64))
    assert distances(x, y, 0)[0, 0] == pytest.approx(np.mean(np.abs(x - y)))  # analytic


def test_every_template_is_named_after_itself():
    names, shapes = templates()
    found, best = named(7.0 * shapes + 3.0, Params())
    assert found.tolist() == list(names) and best.tolist() == list(range(len(names)))


def of(op="triangle", pv="square", n=3000, period=60.0, noise=0.05, gain=1.0, offset=0.0, op_gain=1.0, dt=1.0,
       process="self_regulating"):  # fmt: skip
    t = dt * np.arange(n / dt)
    rng = np.random.default_rng(2)

    def wave(kind, u):
        u = u % 1.0
        return {"square": np.where(u < 0.5, 1.0, -1.0), "sine": np.sin(2 * np.pi * u),
                "triangle": 1 - 4 * np.abs((u + 0.25) % 1.0 - 0.5)}[kind]  # fmt: skip

    u = t / period
    return LoopRecord.from_arrays(
        t, pv=gain * (wave(pv, u) + noise * rng.normal(size=len(t))) + offset,
        op=50 + op_gain * (wave(op, u + 0.25) + noise * rng.normal(size=len(t))), sp=0 * t + offset, process=process,
    )  # fmt: skip


@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_words(noise):
    assert detect(of(noise=noise)).verdict == "stiction"
    assert detect(of("sine", "triangle", noise=noise, process="integrating")).verdict == "stiction"
    for op, pv in (("sine", "square"), ("triangle", "sine"), ("square", "triangle")):
        assert detect(of(op, pv, noise=noise)).verdict == "inconclusive"
    sine = detect(of("sine", "sine", noise=noise))
    assert sine.verdict == "inconclusive" and "not cleared" in sine.reason


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of()).index
    for gain, offset, op_gain in ((-3.0, 40.0, -1.0), (0.1, 0.0, 4.0), (1e3, -7.0, 0.02)):
        assert detect(of(gain=gain, offset=offset, op_gain=op_gain)).index == pytest.approx(base, abs=0.1)
    assert detect(of(dt=0.5)).index == pytest.approx(base, abs=0.1)


def test_refusals():
    assert detect(of(process="unknown")).code == "integrating_unknown"
    assert detect(of(period=12.0)).code == "undersampled"
    assert detect(of(), Params(cycles_min=1000)).code == "too_few_cycles"


def test_picture():
    figure = detect(of()).plot()
    figure.canvas.draw()
    labels = [ax.get_legend_handles_labels()[1] for ax in figure.axes]
    assert labels == [["triangle"], ["square"]]
