"""Integrator with reset: closed forms of sums, sawteeth and timers."""

import math

import numpy as np
import pytest
from stickslip.blocks.periodic import Sine, Square
from stickslip.blocks.ports import BlockError
from stickslip.blocks.reset_integrator import ResetIntegrator
from stickslip.blocks.sources import Constant
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference


def test_it_resets_itself_to_a_sawtooth():
    # analytic: 0.5 t until 2, back to -1, then a period of 3/0.5 = 6 s
    run = simulate(wire([Constant("u", 0.5), ResetIntegrator("y", "u", "y", threshold=2.0, to=-1.0)]), 40.0, every=0.73)
    expected = np.where(run.log.t < 4.0, 0.5 * run.log.t, -1.0 + 0.5 * ((run.log.t - 4.0) % 6.0))
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-7)
    resets = [e.t for e in run.events if e.after == "reset"]
    assert resets == pytest.approx([4.0, 10.0, 16.0, 22.0, 28.0, 34.0, 40.0][: len(resets)], abs=1e-8)
    assert run.statistics.steps < 150


def test_only_a_rise_resets():
    clock = Square("r", 0.5, 10.0, mean=0.5, start=3.0)  # 1 from 3 to 8, 13 to 18
    run = simulate(wire([Constant("u", 1.0), clock, ResetIntegrator("y", "u", "r", threshold=0.75)]), 20.0, every=1.0)
    t = run.log.t
    np.testing.assert_allclose(run.log["y"], np.where(t < 3, t, np.where(t < 13, t - 3, t - 13)), atol=1e-9)


def test_a_smooth_signal_resets_where_it_crosses():
    parts = [Sine("u", 1.0, 7.0), Sine("r", 1.0, 10.0), ResetIntegrator("y", "u", "r", rate=2.0, to=0.3)]
    ours = simulate(wire(parts), 30.0, every=0.3, rtol=1e-9, atol=1e-11)
    theirs = simulate_reference(wire(parts), 30.0, every=0.3)
    np.testing.assert_allclose(ours.log["y"], theirs.log["y"], atol=1e-7)
    w = 2 * np.pi / 7.0
    at = 10.0 / 12.0  # analytic: sin = 1/2; the last reset is two periods later
    expected = 0.3 + 2.0 / w * (math.cos(w * (at + 20.0)) - math.cos(w * 30.0))
    assert ours.log["y"][-1] == pytest.approx(expected, abs=1e-7)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match="threshold = nan, but it must be a finite number"):
        ResetIntegrator("y", "u", "r", threshold=math.nan)
