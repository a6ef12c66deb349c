import pickle

import numpy as np
import pytest
from stickslip.detect.stream import Buffer, LoopFacts, Sample


def test_buffer_keeps_order_over_chunks():
    b = Buffer()
    for i in range(500):
        b = b.append(float(i), Sample(i, 2 * i))
    assert len(b) == 500
    assert b.rows()[:, 0].tolist() == list(range(500))
    assert b.last(7).rows()[:, 1].tolist() == list(range(493, 500))
    assert len(b.last(0)) == 0
    assert pickle.loads(pickle.dumps(b)).rows().shape == (500, 5)


def test_appending_leaves_the_old_buffer():
    old = Buffer().append(0.0, Sample(1, 2))
    old.append(1.0, Sample(3, 4))
    assert len(old) == 1


def test_time_must_advance():
    b = Buffer().append(1.0, Sample(1, 2))
    with pytest.raises(ValueError, match="time must increase"):
        b.append(1.0, Sample(1, 2))


def test_record_round_trip(wave, loop):
    t = np.arange(100.0)
    record = loop(t, wave("sine", t), process="integrating")
    b = Buffer()
    for row in zip(t, record.pv, record.op, record.sp, strict=True):
        b = b.append(row[0], Sample(*row[1:]))
    again = b.record(LoopFacts.of(record))
    assert (again.process, again.name, again.op_span) == ("integrating", "FIC1", (0.0, 100.0))
    assert (again.e == record.e).all()
