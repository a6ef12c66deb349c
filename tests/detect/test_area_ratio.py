"""The area ratio of a wave: closed forms, words, what it never accuses or clears, and its interval."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter
from stickslip.detect.half_waves.lateness import Lateness, Side
from stickslip.detect.methods import area_ratio
from stickslip.detect.methods.area_ratio import Params, closed_form, detect
from stickslip.logs import LoopRecord


def test_closed_form_meets_the_integral():
    """Analytic: areas of 1 - (1 + a) exp(-s), the response of a unit lag to a square wave, by quadrature."""
    from scipy.integrate import quad

    for h in (0.5, 1.0, 2.0, 25 / 8, 5.0):
        a = np.tanh(h / 2)
        zero = np.log1p(a)
        before = quad(lambda s, a=a: 1 - (1 + a) * np.exp(-s), zero, h)[0]
        after = -quad(lambda s, a=a: 1 - (1 + a) * np.exp(-s), 0, zero)[0]
        assert closed_form(h) == pytest.approx(before / after, rel=1e-9)


def test_closed_form_values():
    # values in the design notes, derived there by hand: h = 1, 2, 3.125, 5
    for h, R in ((1, 1.92), (2, 3.44), (3.125, 5.86), (5, 11.1)):
        assert closed_form(h) == pytest.approx(R, rel=0.005)


def test_exponential_wave(wave, loop):
    t = np.arange(0.0, 1000.0, 0.5)
    v = detect(loop(t, wave("exponential", t)))
    assert v.verdict == "stiction"
    assert v.index == pytest.approx(closed_form(25 / 8), rel=0.02)  # analytic


def test_fall_of_three_samples(wave, loop):
    """The corner is found from samples beyond the next crossing too."""
    t = np.arange(0.0, 2000.0)
    v = detect(loop(t, wave("exponential", t, phase=0.007, tau=4.0)))
    assert v.index == pytest.approx(closed_form(25 / 4), rel=0.03)  # analytic


BOTH = {"above": Side(1.3, 10), "below": Side(1.3, 10)}
SEEN = SimpleNamespace(centre="SP", period=50.0)


@pytest.mark.parametrize(
    "R, low, high, sides, word, why",
    [
        (1.3, 1.2, 1.5, BOTH, "stiction", "late on both sides"),
        (1.3, 1.05, 1.6, BOTH, "inconclusive", "neither"),
        (1.2, 1.15, 1.24, BOTH, "inconclusive", "neither"),
        (1.0, 0.9, 1.3, BOTH, "inconclusive", "neither"),
        (0.8, 0.7, 0.85, BOTH, "inconclusive", "early"),
        (0.88, 0.85, 0.9, BOTH, "inconclusive", "early"),
        (1.0, 0.9, 1.2, BOTH, "inconclusive", "not cleared"),
        (
            1.9,
            1.5,
            2.4,
            {"above": Side(1.10, 10), "below": Side(2.72, 10)},
            "inconclusive",
            "while PV is above SP; a",
        ),
        (
            1.9,
            1.5,
            2.4,
            {"above": Side(2.72, 10), "below": Side(1.10, 10)},
            "inconclusive",
            "while PV is below SP; a",
        ),
        (1.9, 1.5, 2.4, {"above": Side(1.9, 10)}, "inconclusive", "lie below SP"),
        (1.9, 1.5, 2.4, {"above": Side(1.9, 2), "below": Side(1.9, 10)}, "inconclusive", "lie above SP"),
    ],
)
def test_bands(R, low, high, sides, word, why):
    said = area_ratio._word(Lateness(R, low, high, sides), SEEN, False, Params())
    assert said[0] == word
    assert why in said[1]


@pytest.mark.parametrize("period", [50, 83.7, 400])
def test_sine_is_one(wave, loop, period):
    t = np.arange(20.0 * int(period))
    v = detect(loop(t, wave("sine", t, period, phase=0.17)))
    assert v.verdict == "inconclusive"
    assert "not cleared" in v.reason
    assert v.index == pytest.approx(1.0, rel=0.005)  # analytic


def test_uneven_sampling(wave, loop):
    t = np.cumsum(np.random.default_rng(5).uniform(0.2, 1.0, 2500))
    assert detect(loop(t, wave("exponential", t))).index == pytest.approx(closed_form(25 / 8), rel=0.02)
    assert detect(loop(t, wave("sine", t))).index == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize("noise", [0.1, 0.2, 0.3])
@pytest.mark.parametrize("seed", range(5))
def test_noise_keeps_the_verdict(wave, loop, noise, seed):
    t, rng = np.arange(1000.0), np.random.default_rng(seed)
    for kind, word in (("sine", "inconclusive"), ("exponential", "stiction")):
        e = wave(kind, t, 50.15, rng.uniform())
        assert detect(loop(t, e + noise * np.std(e) * rng.normal(size=1000))).verdict == word


def test_triangle_is_never_cleared(wave, loop):
    """A triangle has R = 1 as a sine has, but it is the wave of an integrating loop, sticky or not."""
    t = np.arange(1000.0)
    e = wave("triangle", t, 50.15) + 0.02 * np.random.default_rng(0).normal(size=1000)
    v = detect(loop(t, e))
    assert v.index == pytest.approx(1.0, abs=0.03)  # analytic
    assert v.verdict == "inconclusive"
    assert "triangular" in v.reason


def test_square_is_undefined(wave, loop):
    t = np.arange(1000.0)
    e = wave("square", t, 50.3) + 0.02 * np.random.default_rng(0).normal(size=1000)
    v = detect(loop(t, e))
    assert v.verdict == "inconclusive"
    assert v.index is None
    assert "flat" in v.reason


def test_early_peaks_are_like_neither(wave, loop):
    t = np.arange(1000.0)
    v = detect(loop(t, wave("exponential", -t, 50.15)))
    assert v.verdict == "inconclusive"
    assert v.index < 0.5
    assert "early" in v.reason


def test_level_does_not_apply(wave, loop):
    t = np.arange(1000.0)
    v = detect(loop(t, wave("exponential", t), process="integrating"))
    assert (v.verdict, v.code) == ("not_applicable", "wrong_process_type")


@pytest.mark.parametrize("late_side", ["above", "below"])
def test_a_wave_late_on_one_side_is_no_accusation(wave, late_side):
    """PV is late above or below SP = 30, by its own numbers, and a sine on the other side."""
    t = np.arange(2000.0)
    away = wave("exponential", t, 50.15) if late_side == "above" else -wave("exponential", t, 50.15)
    late = away > 0 if late_side == "above" else away < 0
    pv = 30 + np.where(late, away, np.sign(away) * np.abs(np.sin(2 * np.pi * (t / 50.15 - np.log(1.92) * 8 / 50.15))))
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=50 + np.sin(t), sp=np.full(2000, 30.0), process="self_regulating"))
    other = {"above": "below", "below": "above"}[late_side]
    assert v.evidence[f"R_{late_side}"] == pytest.approx(closed_form(25 / 8), rel=0.05)  # analytic
    assert v.evidence[f"R_{other}"] == pytest.approx(1.0, rel=0.05)  # analytic
    assert f"{v.evidence[f'R_{late_side}']:.2f} while PV is {late_side} SP" in v.reason
    assert v.index > Params().R_stiction and v.interval[0] > Params().R_low
    assert v.verdict == "inconclusive"
    assert f"while PV is {other} SP; a sticky valve delays both half waves" in v.reason


@pytest.mark.parametrize("damping", [0.02, 0.1])
def test_a_resonance_driven_by_noise_is_not_accused(loop, damping):
    """Second-order noise of period 50 over six cycles: a tight loop without any valve, its few half cycles ragged."""
    pole = np.exp((-damping + 1j * np.sqrt(1 - damping**2)) * 2 * np.pi / 50)
    for seed in range(60):
        w = np.random.default_rng([5, seed]).normal(size=2300)
        e = lfilter([1], [1, -2 * pole.real, abs(pole) ** 2], w)[2000:]
        assert detect(loop(np.arange(300.0), e)).verdict in ("inconclusive", "not_applicable")


def test_without_a_set_point_the_sides_are_those_of_the_mean(wave):
    t = np.arange(1000.0)
    v = detect(LoopRecord.from_arrays(t, pv=wave("exponential", t, 50.15), op=50 + np.sin(t)))
    assert "while PV is above its mean" in v.reason
    assert "SP," not in v.reason


@pytest.mark.parametrize("tau", [2.0, 8.0, 25.0, 50.0, 125.0, 500.0])
@pytest.mark.parametrize("noisy", [0.0, 0.1, 0.3])
def test_no_lag_and_no_noise_clears_a_sticky_valve(wave, loop, tau, noisy):
    """Square MV through a lag tau of 2 to 500 s, half period 25 s: accused or not, never cleared."""
    t = np.arange(2000.0)
    for seed in range(3):
        rng = np.random.default_rng(seed)
        e = wave("exponential", t, 50.15, rng.uniform(), tau)
        v = detect(loop(t, e + noisy * np.std(e) * rng.normal(size=2000)))
        assert v.verdict in ("stiction", "inconclusive")
        if closed_form(25.075 / tau) < 1.2:
            assert v.verdict == "inconclusive"


def test_the_time_constant_named_is_that_of_the_closed_form(wave, loop):
    """Analytic: a sticky valve behind the lag named has the upper end of the interval for its R."""
    t = np.arange(1000.0)
    e = wave("sine", t, 50.15) + 0.2 * np.random.default_rng(1).normal(size=1000)
    v = detect(loop(t, e))
    tau = float(v.reason.split("time constant above ")[1].split(" s")[0])
    assert closed_form(0.5 * v.evidence["period"] / tau) == pytest.approx(v.interval[1], rel=0.02)


def test_noise_is_hardly_ever_undersampled(noise, loop):
    """A period found in noise must not become advice to log faster; the gate lets pass less than 1.6 % of noises."""
    said = [
        detect(loop(np.arange(1000.0), noise(kind, 1000, seed)))
        for kind in ("white", -0.8, -0.5, 0.5, 0.95, "walk", "loop")
        for seed in range(15)
    ]
    assert {v.verdict for v in said} <= {"not_applicable", "inconclusive"}
    assert sum(v.code == "undersampled" for v in said) <= 2
    assert sum(v.code == "no_oscillation" for v in said) >= 100


@pytest.mark.parametrize("noisy", [0.0, 0.1])
def test_a_drifting_period_is_judged(wave, loop, noisy):
    """Analytic: the wave keeps its shape in its own phase, so R does not change while the period doubles."""
    t = np.arange(20000.0)
    turns = np.cumsum(1 / np.linspace(40.0, 80.0, 20000))
    e = wave("exponential", 50 * turns) + noisy * np.random.default_rng(0).normal(size=20000)
    v = detect(loop(t, e))
    assert v.verdict == "stiction"
    assert "the period drifts between" in v.reason
    assert np.sum(v.array("used")) > 600  # analytic: 346 cycles, 693 half cycles
    if not noisy:
        assert v.index == pytest.approx(closed_form(25 / 8), rel=0.02)


def test_few_usable_half_cycles_do_not_decide(wave, loop):
    t = np.arange(2000.0)
    e = wave("exponential", t, 50.15)
    e = np.where((t // 401) % 2 == 0, e, np.sign(e) * 1.0) + 0.01 * np.random.default_rng(0).normal(size=2000)
    v = detect(loop(t, e), Params(usable_min=0.9))
    assert v.verdict == "inconclusive"
    assert "unusable" in v.reason


def test_interval_covers_the_truth(wave, loop):
    """Analytic R = 1 for a sine; a 90 % interval over 60 noisy records should hold it in at least 45."""
    t, hits = np.arange(1000.0), 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        v = detect(loop(t, wave("sine", t, 50.15, rng.uniform()) + rng.normal(0, 0.15, 1000)))
        hits += v.interval[0] <= 1.0 <= v.interval[1]
    assert hits >= 45


@settings(max_examples=25)
@given(
    scale=st.floats(1e-3, 1e3),
    offset=st.floats(-1e3, 1e3),
    sign=st.sampled_from([-1.0, 1.0]),
    slow=st.floats(1e-2, 1e2),
)
def test_index_ignores_units_sign_and_clock(scale, offset, sign, slow):
    t = np.arange(600.0)
    u = t / 50.15 % 1.0
    e = np.where(u < 0.5, 1.0, -1.0) * (1 - 1.9 * np.exp(-(u % 0.5) * 6))
    e = e + np.random.default_rng(0).normal(0, 0.05, 600)
    op = 50 + np.sin(t)

    def of(time, error, sp):
        return detect(LoopRecord.from_arrays(time, pv=sp - error, op=op, sp=np.full(600, sp)))

    base, changed = of(t, e, 0.0), of(slow * t, sign * scale * e, offset)
    assert changed.verdict == base.verdict == "stiction"
    # offset + small error loses digits, hence not 1e-9
    assert changed.index == pytest.approx(base.index, rel=1e-4)


def test_doubling_the_sampling_changes_little(wave, loop):
    coarse, fine = np.arange(0.0, 1000.0), np.arange(0.0, 1000.0, 0.5)
    a = detect(loop(coarse, wave("exponential", coarse, 50.15))).index
    b = detect(loop(fine, wave("exponential", fine, 50.15))).index
    assert a == pytest.approx(b, rel=0.02)


# ---- streaming ---------------------------------------------------------------------------------------------


def test_wrong_params_are_refused():
    with pytest.raises(ValueError, match="R_low"):
        Params(R_low=2.0)
    with pytest.raises(ValueError, match="block"):
        Params(block=3)
