"""Yamashita's movements: closed forms for a sine and a parallelogram, valves of three models, invariances."""

import math

import numpy as np
import pytest
from stickslip.detect.methods.qualitative_movements import detect, movements
from stickslip.logs import LoopRecord


@pytest.mark.parametrize("level", [0.5, 0.7, 1.0])
def test_quarter_period_of_two_sines(level):
    # analytic: a derivative cos x is within the level for 2 asin(level / sqrt 2) / pi of the time, and then the other,
    # a quarter of a period off, is beyond it, but for what both are: with level <= 1 no SS remains
    t = 2 * np.pi * np.arange(100_000) / 10_000
    found = movements(np.sin(t), np.sin(t - np.pi / 2), level)
    share = 2 * math.asin(level / math.sqrt(2)) / math.pi
    assert found.rho_1 == pytest.approx(share, abs=0.01)
    assert found.rho_3 == pytest.approx(share, abs=0.01)
    ahead = movements(np.sin(t), np.sin(t + np.pi / 2), level)  # the stem ahead of OP: all patterns are wrong
    assert ahead.rho_3 == pytest.approx(0.0, abs=0.02)


def test_stem_that_moves_with_op():  # analytic
    t = 2 * np.pi * np.arange(10_000) / 500
    assert movements(np.sin(t), np.sin(t)).rho_1 == 0.0


def test_stick_then_jump():
    # analytic: OP rises and falls by 1 a sample, 50 each way; the stem stands for 45 (44 pairs) and jumps
    k = np.arange(5000)
    u = np.abs(k % 100 - 50.0)
    x = np.where((k + 55) % 100 < 50, -8.0, 8.0)
    found = movements(u, x, 0.7)
    assert found.rho_3 == pytest.approx(44 / 50, abs=0.01)
    assert np.median(found.J) == pytest.approx(16.0)
    assert np.median(found.S) == pytest.approx(44.5)  # analytic: it jumps as OP goes from 44 to 45 beyond its turn


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
def test_valves(valve, simulated):
    v = detect(simulated(valve, S=6.0, J=4.0))
    assert v.verdict == "stiction", v.reason
    assert 5.0 < v.amount_percent_op < 6.0  # S = 6 %, less what smoothing takes off the turns of OP
    # true: as made, and MV is a fraction here; a move holds what the stem goes on behind its slip, 6 % at most measured
    assert 0.038 < v.evidence["J"] < 0.044


def test_flow_loop_without_mv(sticky, bare):
    v = detect(bare(sticky(S=6.0, J=4.0, noise=0.05, tau=1.0, T_i=8.0, K_p=0.3)))
    assert v.verdict == "stiction" and v.evidence["mv"] == 0.0, v.reason


def test_outside_sine_behind_op(loop):
    t = np.arange(4000.0)
    op, pv = 50 + np.sin(t / 8), 30 + np.sin(t / 8 + 0.3)
    together = LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t + 30, process="self_regulating")
    v = detect(together)
    assert v.verdict == "inconclusive" and "clears nothing" in v.reason


def test_unit_sign_action_and_sampling_do_not_matter(sticky, bare):
    base = sticky(S=6.0, J=4.0, noise=0.05, tau=1.0, T_i=8.0, K_p=0.3)
    first = detect(bare(base))
    for change in ({"gain": -3.0, "offset": 40.0}, {"op_gain": -1.0}, {"op_gain": 0.16}):
        v = detect(bare(base, **change))
        assert v.index == pytest.approx(first.index, rel=1e-6)
        assert v.amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-6)
    half = detect(bare(base, every=2))
    assert half.verdict == first.verdict and half.index == pytest.approx(first.index, abs=0.1)


def test_refusals_and_picture(sticky):
    assert detect(sticky("integrating", noise=0.1)).code == "wrong_process_type"
    assert detect(sticky(S=0.0, J=0.0, noise=0.1)).code == "no_oscillation"
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 2


def test_outside_waves_are_no_movements_of_a_valve(forced, outside_square):
    """A sine a quarter of a period apart has rho_3 = 0.33, above the published limit; its linear twins have it too."""
    for seed in range(6):
        for record in (forced(seed=seed, walk=0.0), outside_square(seed)):
            assert detect(record).verdict != "stiction"
