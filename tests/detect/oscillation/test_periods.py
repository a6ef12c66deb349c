"""Several periods at once, and one that drifts: the waves of two loops on one tag, a period 20 % longer at the end."""

import numpy as np
import pytest
from stickslip.detect.oscillation import acf_crossings, several_periods
from stickslip.detect.prepare.prepared import prepared
from stickslip.logs import LoopRecord


def drifting(kind, wave, n=6000, period=60.0, longer=0.2, noise=0.05, seed=0):
    """A wave whose period grows evenly, and its phase [cycles]."""
    t = np.arange(float(n))
    periods = period * (1.0 + longer * t / n)
    phase = np.concatenate([[0.0], np.cumsum(1.0 / periods)[:-1]])
    x = wave(kind, phase, period=1.0, tau=0.16) + noise * np.random.default_rng(seed).normal(size=n)
    return LoopRecord.from_arrays(t, pv=30 - x, op=50 + 0.02 * np.cumsum(x), sp=np.full(n, 30.0)), phase


@pytest.mark.parametrize("kind", ["sine", "triangle", "exponential"])
@pytest.mark.parametrize("longer", [0.1, 0.2])
def test_a_period_that_drifts_is_found(kind, longer, wave):
    record, phase = drifting(kind, wave, longer=longer)
    gate = acf_crossings.find(record)
    assert gate.oscillating, gate.reason
    assert 60.0 <= gate.period <= 60.0 * (1.0 + longer)  # analytic
    assert gate.cycles == pytest.approx(phase[-1], rel=0.05)  # analytic
    halves = [half for half in prepared(record).cycles.half_cycles if not half.fault or kind == "exponential"]
    assert len(halves) == pytest.approx(2 * phase[-1], rel=0.05)  # analytic


@pytest.mark.parametrize("seed", range(3))
def test_two_loops_on_one_tag(seed, sticky):
    """A slow level that cycles by its valve and a fast flow that does, added with like swings."""
    slow = sticky("integrating", noise=0.02, n=8000, seed=seed)
    fast = sticky(noise=0.02, n=8000, tau=4.0, T_i=4.0, seed=seed)
    own = [acf_crossings.find(record).period for record in (slow, fast)]
    parts = [(record.e - record.e.mean()) / record.e.std() for record in (slow, fast)]
    both = LoopRecord.from_arrays(slow.t, pv=-parts[0] - parts[1], op=slow.op, sp=0 * slow.t)
    found = [gate.period for gate in several_periods.find_all(both)]
    assert own[0] > 2.5 * own[1]
    assert all(any(seen == pytest.approx(period, rel=0.05) for seen in found) for period in own)
    assert len(found) <= 3  # two cycles that wander may leave a third line between them


@pytest.mark.parametrize("swing", [0.4, 1.0, 2.5])
def test_a_period_beside_a_drifting_one(swing, wave):
    record, _ = drifting("sine", wave, period=40.0, longer=0.1)
    slow = wave("sine", record.t, 400.0)
    both = LoopRecord.from_arrays(record.t, pv=record.pv - swing * slow, op=record.op, sp=record.sp)
    found = [gate.period for gate in several_periods.find_all(both)]
    assert any(period == pytest.approx(400.0, rel=0.05) for period in found)


def test_several_periods_are_seldom_found_in_noise(noise):
    """Of 60 noises of six colours, 1,500 samples, at most one may show a period: below 2 %."""
    fired = 0
    for kind in ("white", 0.5, 0.9, "walk", "two lags", "loop"):
        for seed in range(10):
            x = noise(kind, 1500, 900 + seed)
            fired += bool(several_periods.find_all(LoopRecord.from_arrays(np.arange(1500.0), pv=x, op=x)))
    assert fired <= 1
