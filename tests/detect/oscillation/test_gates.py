"""The published oscillation tests beside the default one: closed forms, waves that pass, noises that do not."""

import math

import numpy as np
import pytest
from stickslip.detect import GATES
from stickslip.detect.oscillation import (
    forsman_stattin,
    miao_seborg,
    salsbury_singhal,
    several_periods,
    thornhill1997,
)
from stickslip.detect.oscillation.even import acf, even, regularity
from stickslip.logs import LoopRecord

OTHERS = (forsman_stattin, miao_seborg, salsbury_singhal, several_periods, thornhill1997)
by_name = pytest.mark.parametrize("gate", OTHERS, ids=lambda g: g.CARD.name)


def record(x, h=1.0):
    t = h * np.arange(float(len(x)))
    return LoopRecord.from_arrays(t, pv=x, op=t)


def test_all_are_registered():
    assert set(OTHERS) < set(GATES)


@by_name
@pytest.mark.parametrize("kind", ["sine", "triangle", "exponential"])
@pytest.mark.parametrize("scale", [1.0, -30.0, 1e-3])
def test_waves_pass_with_their_period(gate, wave, kind, scale):
    rng = np.random.default_rng(0)
    x = scale * (wave(kind, np.arange(1000.0)) + 0.02 * rng.normal(size=1000)) + 7.0
    found = gate.find(record(x, 2.5))
    assert found.oscillating, found.reason
    assert found.period == pytest.approx(125.0, rel=0.02)  # analytic
    assert found.cycles == pytest.approx(20, rel=0.08)


@pytest.mark.parametrize("gate", [miao_seborg, salsbury_singhal, several_periods], ids=lambda g: g.CARD.name)
def test_these_shrug_off_noise(gate, wave):
    x = wave("sine", np.arange(1500.0)) + 0.5 * np.random.default_rng(1).normal(size=1500)
    found = gate.find(record(x))
    assert found.oscillating and found.period == pytest.approx(50.0, rel=0.03)


@by_name
@pytest.mark.parametrize("kind", ["white", 0.5, 0.8, 0.95, 0.99, -0.5, -0.8, "walk", "two lags", "loop"])
def test_noise_of_any_colour_is_no_oscillation(gate, noise, kind):
    """Measured rates: none of 800 for the first four, none of 1,200 for several_periods."""
    fired = sum(gate.find(record(noise(kind, n, seed))).oscillating for n in (200, 1000) for seed in range(30))
    assert fired <= 1


@by_name
@pytest.mark.parametrize("x", [np.zeros(500), np.arange(500.0), np.ones(5), np.full(300, np.nan)], ids=str)
def test_nothing_to_see(gate, x):
    found = gate.find(record(x))
    assert not found.oscillating
    assert found.reason.endswith(".")


def test_likeness_by_hand():
    """Analytic: areas 1, 1 / 0.59 (too large), lengths 1, 1 / 0.74 (too long) and two that pass."""
    assert forsman_stattin.likeness(np.array([1.0, 1.0, 1.0, 1 / 0.59]), np.ones(4)) == 0.5
    assert forsman_stattin.likeness(np.ones(4), np.array([1.0, 1.0, 1 / 0.74, 1.0])) == 0.5
    assert forsman_stattin.likeness(np.array([1.0, 9.0, 1.6, 6.0]), np.array([3.0, 5.0, 3.9, 4.0])) == 1.0


@pytest.mark.parametrize("q", [0.3, 0.5, 0.8, 1.0])
def test_decay_ratio_of_a_damped_wave(q):
    """Analytic: extremes 1, -q, q^2, -q^3 ... give R = (q^2 + (q + q^3) / 2) / ((1 + q^2) / 2 + q) = q."""
    k = np.arange(400)
    rho = q ** (k / 40) * np.cos(math.pi * k / 40)
    peaks = q ** np.arange(1.0, 6.0)
    zeros = 20.0 + 40.0 * np.arange(6)
    assert miao_seborg.decay_ratio(rho, zeros) == pytest.approx(q, rel=0.03)
    assert (peaks[3] + (peaks[2] + peaks[4]) / 2) / ((peaks[1] + peaks[3]) / 2 + peaks[2]) == pytest.approx(q)


@pytest.mark.parametrize("zeta", [0.01, 0.05, 0.2])
@pytest.mark.parametrize("period", [8.0, 16.0, 30.0])
def test_mode_of_a_known_damping(zeta, period):
    """Analytic: the ACF of an ARMA(2, 1) mode is exp(-zeta w k) cos(w_d k + phase) from lag 1 on."""
    w_d = 2 * math.pi / period
    k = np.arange(100)
    rho = np.exp(-zeta / math.sqrt(1 - zeta**2) * w_d * k) * np.cos(w_d * k + 0.2)
    rho[0] = 1.5  # noise
    found = salsbury_singhal.mode(rho, 40)
    assert (found.zeta, found.period) == (pytest.approx(zeta, rel=1e-6), pytest.approx(period, rel=1e-6))


def test_a_damped_mode_is_no_oscillation():
    """Analytic: white noise through a mode of damping 0.4 has q = exp(-pi 0.4 / sqrt(1 - 0.16)) = 0.25."""
    from scipy.signal import lfilter

    w = 2 * math.pi / 40
    p = math.exp(-0.4 * w)
    x = lfilter([1], [1, -2 * p * math.cos(w * math.sqrt(1 - 0.16)), p * p], np.random.default_rng(0).normal(size=4000))
    assert not salsbury_singhal.find(record(x)).oscillating
    assert not miao_seborg.find(record(x)).oscillating


@pytest.mark.parametrize("noisy", [0.2, 1.0])
@pytest.mark.parametrize(("slow", "fast"), [(180.0, 37.0), (95.0, 41.0), (400.0, 11.0)])
def test_two_periods_are_both_found(wave, slow, fast, noisy):
    t = np.arange(4000.0)
    x = wave("sine", t, slow) + 0.7 * wave("triangle", t, fast) + noisy * np.random.default_rng(2).normal(size=4000)
    found = several_periods.find_all(record(x))
    assert [gate.period for gate in found] == [pytest.approx(slow, rel=0.03), pytest.approx(fast, rel=0.03)]
    assert found[0].amplitude == pytest.approx(1.0, rel=0.15)  # analytic
    assert several_periods.find(record(x)).period == pytest.approx(slow, rel=0.03)


@pytest.mark.parametrize("kind", ["square", "exponential", "triangle"])
def test_harmonics_are_no_second_period(wave, kind):
    x = wave(kind, np.arange(4000.0), 83.0) + 0.1 * np.random.default_rng(0).normal(size=4000)
    assert [round(gate.period) for gate in several_periods.find_all(record(x))] == [83]


def test_even_bridges_and_detrends():
    t = np.arange(300.0)
    pv = np.sin(t / 8) + 0.1 * t
    pv[100:102] = np.nan
    found = even(LoopRecord.from_arrays(t, pv=pv, op=t))
    assert len(found.x) >= 296 and abs(found.x.mean()) < 1e-9
    assert acf(found.x)[0] == 1.0
    assert regularity(np.array([1.0, 2.0])) == 0.0
