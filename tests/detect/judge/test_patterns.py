"""Patterns against plain numpy and closed forms, their indifference to sign, and what they cost."""

import time
from functools import cache

import numpy as np
import pytest
from stickslip.detect.judge.features import view_of
from stickslip.detect.judge.features.channels import BINS, EVEN, ODD, channels, since_turn
from stickslip.detect.judge.features.convolutions import averaged, convolved, pooled, travelled
from stickslip.detect.judge.features.patterns import FILE, Kernels, Readout, pattern_features, pooled_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord


def view(pv, op):
    t = np.arange(float(len(op)))
    return view_of(Prepared(LoopRecord.from_arrays(t, pv=pv, op=50 + op, sp=0 * t)))


T = np.arange(1500.0)
WAVE = 2 * np.pi * T / 60
TRIANGLE = 2 / np.pi * np.arcsin(np.sin(2 * np.pi * T / 60))


@cache
def sticking():
    """Return a loop that sticks."""
    return view(np.sign(np.roll(TRIANGLE, 15)) + 0.05 * np.random.default_rng(1).normal(size=1500), 5 * TRIANGLE)


@cache
def swinging():
    """Return a loop that swings."""
    return view(np.cos(WAVE) + 0.05 * np.random.default_rng(2).normal(size=1500), 5 * np.sin(WAVE))


def test_travel_since_a_turn_of_a_triangle():
    w = travelled(np.array([0.0, 1, 2, 3, 2, 1, 0, 1]), 0.5)
    assert w.tolist() == [0.0, 1, 2, 3, -1, -2, -3, 1]  # analytic
    small = np.array([0.0, 1, 2, 1.8, 3])  # a way back of 0.2 is no turn
    assert travelled(small, 0.5).tolist() == [0.0, 1, 2, 1.8, 3]


def test_kernels_are_convolutions_of_averages():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(4, 90)).astype(np.float32)
    smooth = averaged(x, 3)
    assert smooth == pytest.approx(np.stack([np.convolve(row, np.ones(3) / 3, "valid") for row in x]), abs=1e-5)
    channel, weight = np.array([2, 0, -1]), rng.normal(size=(3, 9)).astype(np.float32)
    z = np.empty(90, dtype=np.float32)
    n = convolved(smooth, channel, weight, 3, z)
    at = np.arange(n)[:, None] + 3 * np.arange(9)
    assert n == 88 - 24
    assert z[:n] == pytest.approx(smooth[2][at] @ weight[0] + smooth[0][at] @ weight[1], abs=1e-4)


def test_what_is_pooled():
    x = np.tile(np.float32([1.0, -1.0]), 50)[None]
    weight = np.zeros((1, 3, 9), dtype=np.float32)
    weight[0, 0, 0] = 2.0  # z is the channel twice over
    limit = np.float32([[-3.0, 0.0, 1.0, 2.5]])
    out, z = np.empty((1, 6), dtype=np.float32), np.empty(100, dtype=np.float32)
    channel = np.array([[0, -1, -1]])
    pooled(x, 1, np.array([0]), channel, weight, limit, False, z, out)
    assert out[0] == pytest.approx([1.0, 0.5, 0.5, 0.0, np.log(2.0), 0.0], abs=1e-5)  # analytic
    pooled(x, 1, np.array([0]), channel, weight, limit, True, z, out)
    assert out[0] == pytest.approx([1.0, 1.0, 1.0, 0.0, np.log(2.0), 0.0], abs=1e-5)  # |z| is 2, its kurtosis 1
    pooled(x[:, :20], 1, np.array([0]), channel, weight, limit, True, z, out)
    assert np.isnan(out).all()


def test_the_sign_of_odd_channels_does_not_matter():
    read = Readout.read(FILE)
    x = channels(sticking())[0]
    assert read.odd(-x) == pytest.approx(read.odd(x), abs=1e-5)


def test_channels_are_scale_free_and_of_one_time():
    odd, even, since = channels(swinging())
    assert odd.shape[0] == ODD and even.shape[0] == EVEN and since.shape == (4 * BINS,)
    assert odd[:2].std(axis=1) == pytest.approx([1.0, 1.0], abs=0.01)
    turns = np.flatnonzero(np.diff(np.sign(odd[0])) != 0)
    assert np.median(np.diff(turns)) == pytest.approx(16.0, abs=1.0)  # half a period is a turn


def test_pv_that_moves_after_a_travel_of_op_is_seen_there():
    w = np.tile(np.linspace(0.0, 0.99, 50), 20) * np.repeat([1.0, -1.0], 50).repeat(10)
    jump = np.where((np.abs(w) > 0.6) & (np.abs(w) < 0.7), np.sign(w), 0.0)
    mean, square = since_turn(w, jump, 0 * w)[: 2 * BINS].reshape(2, BINS)
    assert np.argmax(mean) == np.argmax(square) == 6 and mean[:5] == pytest.approx(np.zeros(5))


def test_a_stick_scores_higher_than_a_wave_from_outside():
    stick, sine = pattern_features(sticking()), pattern_features(swinging())
    assert stick["pattern_sticky"] > sine["pattern_sticky"] + 0.3
    assert sine["pattern_external_sine"] > stick["pattern_external_sine"]


def test_it_is_kept_and_read_the_same(tmp_path):
    read = Readout.read(FILE)
    read.write(tmp_path / "again.npz")
    again = Readout.read(tmp_path / "again.npz")
    x = pooled_of(sticking(), read.odd, read.even)
    assert np.array_equal(again.scores(x), read.scores(x)) and again.names == read.names
    assert isinstance(again.odd, Kernels) and FILE.stat().st_size < 2_000_000


def test_cost():
    # 5 ms on a quiet machine; processor time, the best of five, and room for a slow one
    pattern_features(sticking())
    spent = []
    for _ in range(5):
        began = time.process_time()
        pattern_features(sticking())
        spent.append(time.process_time() - began)
    assert min(spent) < 0.025
