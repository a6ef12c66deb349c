"""Bands from a path, and the likelihood that follows where a stem came to rest: against stems whose bands are known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.blocks import ChenValve, HeValve, Recorded
from stickslip.diagram import simulate, wire
from stickslip.remedy.process import Loop, day_of, predicted, settled, start_noise
from stickslip.remedy.search import LEAST, MOST
from stickslip.remedy.slips import banded

from benchmarks.remedy.apart import drawn

WIDE = {"low": -math.inf, "high": math.inf}


@pytest.mark.parametrize(("follows", "valve"), [(False, HeValve.from_bands), (True, ChenValve)])
def test_bands_are_those_of_the_stem(follows, valve):
    t = np.arange(4000.0)
    op = 8.0 * np.sin(t / 60.0) + 2.0 * np.sin(t / 17.0)
    loop = wire([Recorded("OP", t, op, hold="previous"), valve(5.0, 2.0, 1.0, **WIDE)])
    stem = simulate(loop, 3999.0, every=1.0).log["MV"]
    day = day_of(t, op, stem + np.random.default_rng(1).normal(size=4000), None)
    path = np.vstack([stem, stem]) - op[0]
    found = banded([day], Loop(follows, 9.0, 0.0, False, 1.0, 9.0, 0.0, 0.0, 0.5), [path], LEAST, MOST)
    # analytic: f_s = 3.5 and f_d = 1.5, but for what OP moves in a scan
    assert pytest.approx(5.0, abs=0.2) == found.S
    assert pytest.approx(2.0, abs=0.3) == found.J
    assert found.r < 0.1


def test_a_path_with_hardly_a_slip_tells_no_bands():
    t = np.arange(400.0)
    day = day_of(t, np.sin(t / 9.0), np.cos(t / 5.0), None)
    one = Loop(False, 4.0, 1.0, False, 1.0, 9.0, 0.0, 0.0)
    assert banded([day], one, [np.zeros((2, 400))], LEAST, MOST) == one


def at_truth(seed, samples=None):
    """A hidden loop's day and the loop that made it, with the noise that goes with it."""
    plant = drawn(seed)
    record, n = plant.record(), plant.numbers
    rows = slice(samples)
    day = day_of(record.t[rows], record.op[rows], record.pv[rows], record.sp[rows])
    tau = 1.0 if plant.integrating else n.T_1
    one = Loop(True, n.S, n.J, plant.integrating, n.K, tau, n.T_2 + n.T_3, n.theta + n.air)
    noises = start_noise([day], plant.integrating)
    for _ in range(4):
        one, noises = settled([day], one, predicted([day], one, noises).shown)
    return day, plant, one, noises


@pytest.mark.parametrize("seed", [8, 11])
def test_the_gain_of_an_integrator_under_a_load_that_wanders_is_not_lost(seed):
    # with eight rows of memory, of three samples each, seed 8 kept 0.54 of its gain
    _, plant, one, _ = at_truth(seed)
    assert pytest.approx(1.0, abs=0.12) == one.K / plant.numbers.K


def test_where_a_stem_comes_to_rest_is_followed_and_not_drawn():
    # snapshot: where it was drawn, the same record was likely by 3535 nats, give or take 54
    rng, t, x, stands = np.random.default_rng(5), np.arange(3000.0), np.zeros(3000), 0.0
    op = 8.0 * np.sin(t / 60.0) + 2.0 * np.sin(t / 17.0)
    for k in range(3000):  # f_s = 3.5, f_d = 1.5 give or take 0.4
        if abs(op[k] - stands) > 3.5:
            stands = op[k] - np.sign(op[k] - stands) * (1.5 + 0.4 * rng.normal())
        x[k] = stands
    keeps = math.exp(-0.1)
    pv = 1.5 * lfilter([0.0, 1.0 - keeps], [1.0, -keeps], x) + 0.05 * rng.normal(size=3000)
    day = replace(day_of(t, op, pv, None), q=1)
    one, noises = Loop(False, 5.0, 2.0, False, 1.5, 10.0, 0.0, 0.0, 0.11), start_noise([day])
    for _ in range(4):
        one, noises = settled([day], one, predicted([day], one, noises).shown)
    nll = [predicted([day], one, noises, draw).nll for draw in range(1, 9)]
    assert np.mean(nll) < -3800.0
    assert np.std(nll) < 40.0
