"""The area ratio as a stream: its verdict is that of the batch, its memory is bounded, its states are values."""

import itertools
import pickle

import numpy as np
import pytest
from stickslip.detect import stream
from stickslip.detect.methods import area_ratio
from stickslip.detect.methods.area_ratio import Params, detect

from tests.detect.one_by_one import replay


@pytest.mark.parametrize("kind", ["sine", "exponential"])
def test_stream_equals_batch_within_one_block(wave, loop, kind):
    t = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 1500))
    record = loop(t, wave(kind, t) + 0.1 * np.random.default_rng(1).normal(size=1500))
    p = Params()
    twin = area_ratio.verdict(p, replay(area_ratio, record, p))
    assert twin.to_dict() == detect(record, p).to_dict()


@pytest.mark.parametrize("kind", ["sine", "exponential"])
@pytest.mark.parametrize("noise", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("seed", range(3))
def test_stream_meets_the_bound_of_the_card(wave, loop, kind, noise, seed):
    rng = np.random.default_rng(seed)
    t = np.arange(9000.0)
    record = loop(t, wave(kind, t, 50.15, rng.uniform()) + noise * rng.normal(size=9000))
    p = Params(block=1024)
    twin, batch = area_ratio.verdict(p, replay(area_ratio, record, p)), detect(record, p)
    assert twin.verdict == batch.verdict
    assert twin.index == pytest.approx(batch.index, rel=area_ratio.CARD.stream_bound)


def test_no_half_cycle_is_lost_or_counted_twice(wave, loop):
    t = np.arange(6000.0)
    p = Params(block=512)
    state = replay(area_ratio, loop(t, wave("exponential", t, 50.15)), p)
    found = [*state.half_cycles]
    assert len(found) > 200
    for a, b in itertools.pairwise(found):
        assert b.start == pytest.approx(a.end, abs=0.05)


def test_memory_is_bounded(wave, loop):
    t = np.arange(8000.0)
    p = Params(block=256, half_cycles_max=40)
    state = replay(area_ratio, loop(t, wave("sine", t)), p)
    assert len(state.buffer) < p.block
    assert len(state.half_cycles) <= p.half_cycles_max


def test_stream_forgets_an_oscillation_that_stopped(wave, loop):
    t = np.arange(4000.0)
    e = np.where(t < 2000, wave("exponential", t, 50.15), 0) + 0.05 * np.random.default_rng(0).normal(size=4000)
    p = Params(block=512)
    v = area_ratio.verdict(p, replay(area_ratio, loop(t, e), p))
    assert v.code == "no_oscillation"


def test_states_are_values(wave, loop):
    p = Params(block=128)
    state = area_ratio.init(p)
    seen = []
    for i in range(300):
        e = float(wave("sine", float(i)))
        new = area_ratio.update(p, state, float(i), stream.Sample(pv=30 - e, op=50 + e, sp=30.0))
        seen.append((state, len(state.buffer)))
        state = new
    assert all(len(old.buffer) == n for old, n in seen)
    again = pickle.loads(pickle.dumps(state))
    assert area_ratio.verdict(p, again).to_dict() == area_ratio.verdict(p, state).to_dict()


def test_empty_stream_says_so():
    v = area_ratio.verdict(Params(), area_ratio.init(Params()))
    assert v.verdict == "not_applicable"
