"""Kano's method B: an exact play comes back, with and without MV, and a lag is not taken for one."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.methods.parallelogram import detect, sizes_of, width
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord


def swings(n=1500):
    t = np.arange(float(n))
    return 50 + 5 * np.sin(t / 15) + 2 * np.sin(t / 47)


@pytest.mark.parametrize("S", [2.5, 4.0, 7.0])
def test_exact_play(S):  # analytic: y is the play of u
    u = swings()
    found = width(u, -3.0 * stick(u, S) + 7.0, 47.0)
    assert abs(found.S - S) < 0.005 * S
    assert found.best > 0.999 and found.lag == 0
    assert found.low <= found.S <= found.high


def test_recursion_of_the_paper():  # analytic: OP - F of the paper is the play, but for a constant
    u, F, S = swings(), 0.0, 4.0
    x = [u[0]]
    for k in range(1, len(u)):
        F = max(min(F + u[k] - u[k - 1], S), 0.0)
        x.append(u[k] - F)
    ours = stick(u, S, 0.0, -1.0)  # F(0) = 0: OP stands at the lower end of the band
    assert np.ptp(ours - np.array(x)) < 1e-9


def test_delay_is_compensated():
    u = swings()
    late = np.concatenate([np.zeros(8), stick(u, 4.0)[:-8]])
    found = width(u, late, 47.0)
    assert abs(found.S - 4.0) < 0.2 and abs(found.lag - 8) <= 2


def test_lag_is_not_a_play():
    t = np.arange(2000.0)
    u = 50 + 5 * np.sin(t / 15)
    for lag in (5, 20, 40):
        v = detect(LoopRecord.from_arrays(t, pv=np.roll(u, lag), op=u, process="self_regulating"))
        assert v.verdict == "inconclusive"


@pytest.mark.parametrize("wave", ["swings", "triangle"])
@pytest.mark.parametrize("J", [0.0, 1.0, 2.0, 4.0])
def test_amounts_of_a_stick(wave, J):  # analytic: y is the stick of S = 4 and J, as made
    u = swings(2000) if wave == "swings" else 50 + 8 * (np.abs((np.arange(2000.0) % 400) / 200 - 1) - 0.5)
    y = 7.0 - 3.0 * stick(u, 4.0, J)
    found = sizes_of(u, y, width(u, y, 47.0 if wave == "swings" else 200.0))
    assert pytest.approx(4.0, rel=0.03) == found.S
    assert pytest.approx(J, abs=0.15) == found.J
    assert found.low <= found.S <= found.high


def test_amounts_in_a_limit_cycle(sticky):  # true: as made; the play alone is late by some samples there
    for S, J in ((6.0, 4.0), (4.0, 2.0), (4.0, 4.0)):
        loop = sticky(S=S, J=J, tau=2.0, T_i=4.0, K_p=0.3)
        found = detect(loop).evidence
        assert found["S"] == pytest.approx(S, rel=0.08)
        assert found["J"] == pytest.approx(J, rel=0.15)


def test_deadband_with_and_without_mv(sticky, bare, simulated):
    logged = sticky(S=6.0, J=1.0, noise=0.05, K_p=0.9, T_i=3.0)
    assert detect(logged).verdict == "stiction"
    assert detect(logged).amount_percent_op == pytest.approx(6.0, rel=0.2)
    flow = bare(sticky(S=6.0, J=4.0, noise=0.05, tau=2.0, T_i=4.0, K_p=0.3))
    v = detect(flow)
    assert v.verdict == "stiction", v.reason
    assert 3.5 < v.amount_percent_op < 6.5  # the sides of a slip are steeper than those of a play
    assert v.evidence["mv"] == 0.0 and v.evidence["S_low"] < v.amount_percent_op < v.evidence["S_high"]
    assert detect(simulated("he", S=6.0, J=4.0)).verdict == "stiction"


def test_healthy_is_not_accused_nor_cleared(simulated):
    moves = 2.0 * np.cumsum(np.random.default_rng(3).normal(size=20))
    for record in (simulated("kano", S=0.0, J=0.0, moves=moves), simulated("kano", S=0.0, J=0.0)):
        assert detect(record).verdict in ("inconclusive", "not_applicable")


def test_unrelated_signals():
    rng = np.random.default_rng(0)
    op = 50 + lfilter([1], [1, -0.98], rng.normal(size=2000))
    v = detect(LoopRecord.from_arrays(np.arange(2000.0), pv=rng.normal(size=2000), op=op))
    assert v.verdict == "inconclusive" and v.amount_percent_op is None


def test_unit_sign_action_and_sampling_do_not_matter(sticky, bare):
    base = sticky(S=6.0, J=4.0, noise=0.02, tau=2.0, T_i=4.0, K_p=0.3)
    first = detect(bare(base))
    for change in ({"gain": -3.0, "offset": 40.0}, {"op_gain": -1.0}, {"op_gain": 0.16}):
        v = detect(bare(base, **change))
        assert v.index == pytest.approx(first.index, rel=1e-3)
        assert v.amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-3)
    half = detect(bare(base, every=2))
    assert half.verdict == first.verdict and half.amount_percent_op == pytest.approx(first.amount_percent_op, rel=0.2)


def test_refusals_and_picture(sticky):
    assert detect(sticky("integrating", noise=0.1)).code == "wrong_process_type"
    assert detect(sticky(n=170)).code == "too_few_cycles"
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 2
