"""One window for all methods: equal to batch while the record fits, bounded for ever, prepared once a verdict."""

import pickle

import numpy as np
import pytest
from stickslip.detect import METHODS
from stickslip.detect.loop_stream import LoopStream
from stickslip.detect.methods import area_ratio, cross_correlation, hagglund2011, hammerstein, harmonics
from stickslip.detect.pool import Pool, joined
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stream import LoopFacts, Sample

from tests.detect.one_by_one import replay


def fed(record, **more):
    stream = LoopStream(LoopFacts.of(record), **more)
    for t, *row in zip(record.t, record.pv, record.op, record.sp, strict=True):
        stream = stream.update(float(t), Sample(*map(float, row)))
    return stream


@pytest.fixture
def make(wave, loop):
    def record(n):
        t = np.arange(float(n))
        return loop(t, wave("exponential", t) + 0.02 * np.random.default_rng(3).normal(size=n))

    return record


def test_a_record_that_fits_is_judged_as_in_batch(make):
    record = make(1200)
    for method, v in zip(METHODS, fed(record).verdicts(), strict=True):
        batch = method.detect(record)
        assert (v.method, v.verdict, v.code) == (batch.method, batch.verdict, batch.code)
        assert v.index == (None if batch.index is None else pytest.approx(batch.index, rel=1e-9)), v.method
        assert v.experimental == method.CARD.experimental


def test_a_long_record_is_judged_as_by_the_twin_of_each_method(make):
    record = make(5000)
    methods = (area_ratio, hagglund2011)
    for method, v in zip(methods, fed(record, methods=methods).verdicts(), strict=True):
        p = method.Params()
        alone = method.verdict(p, replay(method, record, p))
        assert (v.verdict, v.index, v.reason) == (alone.verdict, alone.index, alone.reason)


def test_window_methods_judge_the_window(make):
    record = make(3000)
    stream = fed(record, methods=(hammerstein,), window=1024)
    rows = stream.buffer.rows()
    assert 512 <= len(rows) <= 1024 and rows[-1, 0] == record.t[-1]
    assert stream.verdicts()[0].index == hammerstein.detect(stream.buffer.record(stream.facts)).index


def test_memory_is_bounded(make):
    """Pieces are kept up to a number, so the state grows to a bound."""
    sizes = [len(pickle.dumps(fed(make(n)))) for n in (6000, 12_000)]
    assert max(sizes) < 1_000_000 and sizes[1] < 1.5 * sizes[0]


def test_pieces_are_kept_up_to_a_number():
    past = None
    for k in range(50):
        now = Pool(np.arange(100.0) + 100.0 * k, np.full((100, 2), float(k)), 100.0 * k)
        past = joined(past, now, most=400)
    assert len(past.at) == 400 and past.at[0] == 4600.0 and past.since == 4599.0 and past.rows[-1, 0] == 49.0


def test_the_window_is_prepared_once(make, monkeypatch):
    stream = fed(make(600), methods=(area_ratio, cross_correlation, harmonics))
    made = []
    start = Prepared.__init__
    monkeypatch.setattr(Prepared, "__init__", lambda self, record: made.append(record) or start(self, record))
    first, second = stream.verdicts(), stream.verdicts()
    assert len(made) == 1 and [v.index for v in first] == [v.index for v in second]


def test_a_stream_is_a_value(make):
    stream = fed(make(700), methods=(area_ratio, hagglund2011, harmonics))
    before = [v.index for v in stream.verdicts()]
    stream.update(1e6, Sample(1.0, 2.0, 3.0))
    assert [v.index for v in stream.verdicts()] == before
    again = pickle.loads(pickle.dumps(stream))
    assert again.methods == stream.methods and [v.index for v in again.verdicts()] == before


def test_before_the_first_sample_and_bad_input():
    assert {v.code for v in LoopStream().verdicts()} == {"too_few_cycles"}
    with pytest.raises(ValueError, match="window = 10 rows"):
        LoopStream(window=10)
    with pytest.raises(ValueError, match="time must increase"):
        LoopStream(methods=(harmonics,)).update(1.0, Sample(1, 2)).update(1.0, Sample(1, 2))
