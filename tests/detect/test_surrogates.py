"""Predictability against linear twins: what is linear scores below 1, what cycles by a valve above, if cycles vary."""

import numpy as np
import pytest
from scipy.signal import butter, sosfilt
from stickslip.detect.methods import surrogates
from stickslip.detect.methods.surrogates import Params, detect, forecast_error
from stickslip.logs import LoopRecord


def narrow(seed, n=6000):
    """White noise through a narrow band about a period of 50, with white noise beside it."""
    rng = np.random.default_rng(seed)
    x = sosfilt(butter(2, [0.017, 0.023], "band", fs=1, output="sos"), rng.normal(size=n + 2000))[2000:]
    return x / np.std(x) + 0.2 * rng.normal(size=n)


def test_white_noise_has_the_error_of_a_mean():
    """Analytic: the mean of K independent values misses another by the variance 1 + 1 / K."""
    x = np.random.default_rng(0).normal(size=(4, 600))
    assert forecast_error(x, 10, 10, 8).mean() == pytest.approx(1 + 1 / 8, rel=0.08)


def test_what_repeats_is_forecast_exactly(wave):
    x = wave("exponential", np.arange(600.0), 20.0)
    assert forecast_error(x[None], 20, 20)[0] < 1e-20


def test_forecasts_as_a_plain_loop_makes_them():
    """An independent slow version of the definition."""
    x = np.cumsum(np.random.default_rng(1).normal(size=120))
    E = H = 6
    K, wrong = 3, []
    last = range(len(x) - E - H + 1)
    for i in last:
        away = sorted((np.sum((x[i : i + E] - x[j : j + E]) ** 2), j) for j in last if abs(i - j) >= E)
        predicted = np.mean([x[j + E - 1 + H] for _, j in away[:K]])
        wrong.append((x[i + E - 1 + H] - predicted) ** 2)
    assert forecast_error(x[None], E, H, K)[0] == pytest.approx(np.mean(wrong))


def test_too_short_a_signal_is_refused():
    with pytest.raises(ValueError, match="longer signal"):
        forecast_error(np.zeros((1, 30)), 10, 10)


def test_linear_waves_score_below_one(wave, loop, forced):
    t = np.arange(1500.0)
    records = [
        loop(
            t[: 1300 + 7 * seed],
            (wave("sine", t, 53.0) + share * np.random.default_rng(seed).normal(size=1500))[: 1300 + 7 * seed],
        )
        for share in (0.0, 0.1, 0.3)
        for seed in range(3)
    ]
    records += [loop(np.arange(6000.0), narrow(seed)) for seed in range(4)]
    records += [forced(n=4000, seed=seed) for seed in range(4)]
    found = [detect(record).index for record in records]
    assert sum(index > 1 for index in found if index is not None) == 0
    assert sum(index is not None for index in found) >= 14


def test_a_cycling_valve_under_a_wandering_load_scores_above_one(sticky):
    found = [detect(sticky(n=8000, noise=0.1, walk=0.02, seed=seed)).index for seed in range(6)]
    assert sum(index > 1 for index in found) >= 3  # measured: 7 of 10


def test_exact_repetition_is_a_blind_spot(wave, loop):
    """Published as an artefact of strictly cyclic data: the twins repeat as well, whatever the shape."""
    t = np.arange(2000.0)
    for kind in ("square", "exponential", "triangle"):
        v = detect(loop(t, wave(kind, t, 48.0) + 0.02 * np.random.default_rng(0).normal(size=2000)))
        assert v.code is not None or v.index < 1


def test_it_judges_no_valve(sticky):
    v = detect(sticky(n=9000, noise=0.1, walk=0.03))
    assert v.verdict == "inconclusive" and "judges no valve" in v.reason


def test_offset_scale_and_sign(sticky):
    base = sticky(n=8000, noise=0.1, walk=0.02)
    first = detect(base)
    for gain, offset in ((-3.0, 40.0), (1e3, -7.0)):
        pv, sp = gain * base.pv + offset, gain * base.sp + offset
        other = LoopRecord.from_arrays(base.t, pv=pv, op=base.op, sp=sp, process="self_regulating")
        assert detect(other).index == pytest.approx(first.index, abs=0.8 if gain < 0 else 1e-6)  # cut half a cycle on


def test_refusals(wave, loop):
    t = np.arange(500.0)
    assert detect(loop(t, wave("sine", t, 50.0))).code == "too_few_cycles"
    assert Params().limit == 1.0


def test_picture(sticky):
    figure = detect(sticky(n=9000, noise=0.1, walk=0.03)).plot()
    figure.canvas.draw()
    assert "twins" in figure.axes[1].get_xlabel()
    assert surrogates.CARD.experimental and not surrogates.CARD.accuses
