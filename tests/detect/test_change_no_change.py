"""Kano's method A: the share of time and the travel of a stem that stands, known from how the wave is made."""

import numpy as np
import pytest
from stickslip.detect.methods.change_no_change import detect, stuck
from stickslip.logs import LoopRecord


def parallelogram(n=4000, period=200, hold=0.6, S=5.0):
    """OP a triangle; y stands for the share `hold` of each half period and then moves evenly: analytic rho = hold."""
    part = np.arange(float(n)) % period / period
    u = 50 + (S / hold) * (np.abs(2 * part - 1) - 0.5)
    half = (2 * part) % 1.0
    way = np.where(part < 0.5, -1.0, 1.0)
    y = way * np.where(half < hold, -1.0, 2 * (half - hold) / (1 - hold) - 1.0)
    return u, y


@pytest.mark.parametrize("hold", [0.4, 0.6, 0.8])
def test_share_and_travel(hold):  # analytic: stands for `hold` of the time while OP travels S
    u, y = parallelogram(hold=hold)
    found = stuck(u, y, 1, 0.0, float(np.ptp(u)))
    assert found.rho == pytest.approx(hold, abs=0.03)
    assert np.median(found.travel) == pytest.approx(5.0, rel=0.05)


def test_sine_hardly_counts():  # analytic: |dy| < 1 % of the range over 1/200 of a period for 2 asin(0.64)/pi = 44 %,
    t = np.arange(4000.0)  # but then y moves by more than twice eps
    u, y = np.cos(t * 2 * np.pi / 200), np.sin(t * 2 * np.pi / 200)
    assert stuck(u, y, 7, 0.0, 2.0).rho < 0.1


def test_words_and_amount():
    u, y = parallelogram()
    rng = np.random.default_rng(0)
    t = np.arange(float(len(u)))
    for noise in (0.0, 0.02):
        pv, mv = y + 0.1 * rng.normal(size=len(t)), y + noise * rng.normal(size=len(t))
        record = LoopRecord.from_arrays(t, pv=pv, op=u, mv=mv, process="self_regulating")
        v = detect(record)
        assert v.verdict == "stiction", v.reason
        assert v.amount_percent_op == pytest.approx(5.0, rel=0.15)
        assert v.evidence["S_low"] <= v.amount_percent_op <= v.evidence["S_high"]


def test_sticky_flow_loop_without_mv(sticky, bare):
    v = detect(bare(sticky(S=6.0, J=4.0, noise=0.02, tau=1.0, T_i=8.0, K_p=0.3)))
    assert v.verdict == "stiction", v.reason
    assert 4.0 < v.amount_percent_op < 6.5  # S = 6 %, less what the lag of PV hides


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
def test_valves(valve, simulated):
    v = detect(simulated(valve, S=6.0, J=4.0))
    assert v.verdict == "stiction"
    assert v.amount_percent_op == pytest.approx(6.0, rel=0.15)


def test_clears_nothing(simulated):
    moves = 2.0 * np.cumsum(np.random.default_rng(3).normal(size=20))
    v = detect(simulated("kano", S=0.0, J=0.0, moves=moves))
    assert v.verdict == "inconclusive" and "clears nothing" in v.reason


def test_load_ramp_proves_nothing():
    t, rng = np.arange(2000.0), np.random.default_rng(0)
    pv = 30 + np.where(t % 500 < 450, 0.0, 3.0) + 0.02 * rng.normal(size=2000)
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=40 + 0.01 * t, sp=0 * t + 30))
    assert v.verdict == "inconclusive"


def test_unit_sign_action_and_sampling_do_not_matter(sticky, bare):
    base = sticky(S=6.0, J=4.0, noise=0.02, tau=1.0, T_i=8.0, K_p=0.3)
    first = detect(bare(base))
    for change in ({"gain": -3.0, "offset": 40.0}, {"op_gain": -1.0}, {"op_gain": 0.16}):
        assert detect(bare(base, **change)).index == pytest.approx(first.index, rel=1e-6)
    assert detect(bare(base, every=2)).verdict == first.verdict


def test_refusals_and_picture(sticky):
    assert detect(sticky("integrating", noise=0.1)).code == "wrong_process_type"
    assert detect(sticky(n=170, noise=0.1)).code == "too_few_cycles"
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 2
