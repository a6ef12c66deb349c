"""Sine, square, triangle, slug: shapes, averages, announced kinks; expected numbers are analytic."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.periodic import Sine, Slug, Square, Triangle, whole
from stickslip.diagram import simulate, wire


def at(block, t):
    return float(block.output(t, [], [])[0])


def upcoming(block, t):
    out = np.array([np.inf, np.inf])
    block.kernels.next_time(t, block.x0, block.d0, np.zeros(0), block.p, out)
    return out


@given(
    k=st.integers(-1000, 100_000),
    start=st.floats(-1e3, 1e3),
    length=st.floats(1e-2, 1e3),
)
def test_intervals_are_counted_exactly_as_their_ends_are_rounded(k, start, length):
    end = start + k * length
    assert whole(end, start, length) == k
    assert whole(np.nextafter(end, -np.inf), start, length) == k - 1


@given(
    make=st.sampled_from([Square, Triangle, Slug]),
    period=st.floats(0.01, 1e4),
    start=st.floats(-100.0, 100.0),
)
def test_announced_instants_increase_and_follow_the_period(make, period, start):
    wave = make("D", 1.0, period, start=start)
    t, times = start - 1.0, []
    for _ in range(41):
        ahead = upcoming(wave, t)[0]
        assert ahead > t
        t = ahead
        times.append(t)
    # start, then two kinks or jumps per period
    assert times[0] == start
    assert times[-1] - times[-3] == pytest.approx(period, rel=1e-9, abs=1e-9)


@given(
    make=st.sampled_from([Sine, Square, Triangle, Slug]),
    t=st.floats(-1e4, 1e4),
    mean=st.floats(-5.0, 5.0),
    amplitude=st.floats(0.0, 5.0),
)
def test_waves_stay_within_their_amplitude_and_at_their_mean_before_the_start(make, t, mean, amplitude):
    wave = make("D", amplitude, 7.3, mean=mean, start=3.0)
    assert abs(at(wave, t) - mean) <= amplitude * (1 + 1e-9) + 1e-12
    if t < 3.0:
        assert at(wave, t) == mean


@pytest.mark.parametrize("make", [Sine, Square, Triangle, Slug])
def test_the_average_over_a_period_is_the_mean(make):
    wave = make("D", 2.0, 10.0, mean=3.0)
    middles = (np.arange(10_000) + 0.5) * 1e-3
    assert np.mean([at(wave, t) for t in middles]) == pytest.approx(3.0, abs=1e-6)


def test_sine_follows_its_formula_and_limits_the_step():
    wave = Sine("D", 2.0, 10.0, mean=1.0, phase=0.3, start=4.0)
    assert at(wave, 6.5) == pytest.approx(1.0 + 2.0 * math.sin(2 * math.pi * 0.25 + 0.3))
    assert upcoming(wave, 0.0).tolist() == [4.0, math.inf]
    assert upcoming(wave, 4.0).tolist() == [math.inf, 10.0 / 24.0]


def test_slug_rises_slowly_and_falls_fast():
    wave = Slug("D", amplitude=1.5, period=100.0, mean=2.0)
    t = np.linspace(0.0, 100.0, 1001)
    y = np.array([at(wave, s) for s in t])
    assert y[0] == pytest.approx(2.0)
    rising = np.diff(y) > 0
    assert np.mean(rising) == pytest.approx(0.8, abs=2e-3)  # 80 % of the period
    assert np.max(y) == pytest.approx(3.5)
    assert np.min(y) == pytest.approx(0.5)
    assert -np.min(np.diff(y)) / np.max(np.diff(y)) == pytest.approx(4.0)  # 80 % / 20 %


def test_square_wave_is_high_during_its_duty():
    wave = Square("D", 1.0, 10.0, duty=0.3)
    assert [at(wave, t) for t in (0.0, 2.99, 3.0, 9.99, 10.0)] == [1.0, 1.0, -1.0, -1.0, 1.0]


def test_compiled_waves_equal_interpreted_ones():
    waves = [
        Sine("A", 1.0, 3.0, phase=0.1),
        Square("B", 2.0, 1.7, start=0.3),
        Triangle("C", 1.0, 2.1),
        Slug("E", 1.0, 2.9),
    ]
    log = simulate(wire(waves, outputs=list("ABCE")), 20.0, every=0.13).log
    for wave, signal in zip(waves, "ABCE", strict=True):
        np.testing.assert_allclose(log[signal], [at(wave, t) for t in log.t], rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sine("D", 1.0, 0.0), ["period = 0.0", "positive", "seconds"]),
        (lambda: Square("D", 1.0, 1.0, duty=1.0), ["duty = 1.0", "between 0 and 1"]),
        (lambda: Slug("D", 1.0, 1.0, rise=0.0), ["rise = 0.0", "between 0 and 1"]),
        (lambda: Sine("D", 1.0, 5.0).with_params(phase=math.nan), ["phase = nan", "finite"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)
