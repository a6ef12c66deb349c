"""Tags that share an oscillation: sines of known period in, groups out; noise and drift make none."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.plantwide.lines import groups, spectra

N = 3000


def tags(seed=0, noise=0.5):
    """Three tags at 60 s, two at 143 s of a record of 3,000 s, each with noise; three of noise alone."""
    rng, t = np.random.default_rng(seed), np.arange(float(N))
    waves = {f"a{i}": (60.0, i) for i in range(3)} | {f"b{i}": (143.0, i) for i in range(2)}
    found = {
        name: 10.0**i * (np.sin(2 * np.pi * t / period + i) + noise * rng.normal(size=N)) + 100.0
        for name, (period, i) in waves.items()
    }
    found |= {"white": rng.normal(size=N), "walk": np.cumsum(rng.normal(size=N)), "still": np.full(N, 7.0)}
    return t, found | {"red": lfilter([1], [1, -0.9], rng.normal(size=N))}


@pytest.mark.parametrize("seed", range(5))
def test_groups_by_period_whatever_unit_phase_and_offset(seed):
    t, signals = tags(seed)
    three, two = groups(spectra(t, signals))
    assert set(three.shares) == {"a0", "a1", "a2"} and set(two.shares) == {"b0", "b1"}
    assert three.period == pytest.approx(60.0, rel=0.01) and two.period == pytest.approx(143.0, rel=0.01)  # analytic
    assert all(0.6 < share <= 1.0 for share in three.shares.values())  # a sine has 0.8 of the variance, noise the rest


def test_a_tag_with_two_oscillations_joins_the_stronger():
    t = np.arange(float(N))
    slow, fast = np.sin(2 * np.pi * t / 300), np.sin(2 * np.pi * t / 50)
    found = groups(spectra(t, {"slow": slow, "fast": fast, "mixed": 2 * slow + fast, "other": fast + 0.1 * slow}))
    assert {round(one.period): set(one.shares) for one in found} == {300: {"slow", "mixed"}, 50: {"fast", "other"}}


def test_noise_and_drift_share_nothing():
    grouped = 0
    for seed in range(40):
        rng = np.random.default_rng([3, seed])
        walks = {f"w{i}": np.cumsum(rng.normal(size=N)) for i in range(4)}
        noises = {f"n{i}": lfilter([1], [1, -0.95], rng.normal(size=N)) for i in range(4)}
        grouped += len(groups(spectra(np.arange(float(N)), walks | noises)))
    assert grouped <= 4  # a walk swings three times in a record now and then


def test_short_still_and_single():
    t = np.arange(30.0)
    assert groups(spectra(t, {"still": 0 * t, "one": np.sin(t)})) == []
    assert groups(spectra(t, {})) == []
