"""Whether the process integrates: from the tag, from the data where SP moves, and not at all where nothing speaks."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.detect import diagnose
from stickslip.detect.prepare.prepared import prepared
from stickslip.detect.stem.process_kind import kind_of_tag
from stickslip.logs import LoopRecord


def untold(record, name="X1"):
    return LoopRecord.from_arrays(record.t, pv=record.pv, op=record.op, sp=record.sp, name=name)


@pytest.mark.parametrize(
    ("measurement", "integrating"),
    [("level", True), ("flow", False), ("pressure", False), ("temperature", None), ("analyser", None), ("", None)],
)
def test_the_tag_speaks_first(measurement, integrating, forced):
    record = replace(untold(forced()), measurement=measurement)
    kind = kind_of_tag(record)
    assert kind.integrating is integrating
    assert prepared(record).integrating is integrating
    assert kind.text in diagnose(record).assumptions


def test_what_is_told_outranks_the_tag(forced):
    record = LoopRecord.from_arrays([0, 1], pv=[1, 2], op=[1, 2], name="FIC1", process="integrating")
    assert kind_of_tag(record).integrating is True


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
@pytest.mark.parametrize("S", [0.0, 4.0])
def test_data_speak_under_set_point_moves(process, S, sticky):
    moves = tuple(3.0 * np.cumsum(np.random.default_rng(3).normal(size=20)))
    said = []
    for seed in range(4):
        record = untold(sticky(process, S=S, J=0.5 * S, noise=0.1, moves=moves, seed=seed))
        kind = prepared(record).kind
        said.append(kind.integrating)
        if kind.integrating is not None:
            assert "moves of SP" in kind.text and kind.text in diagnose(record, []).assumptions
    truth = process == "integrating"
    assert (not truth) not in said  # never the wrong way round
    assert truth in said


def test_nothing_is_inferred_at_a_constant_set_point(forced, sticky, outside_square):
    for record in (forced(), sticky("integrating", noise=0.1), outside_square(0)):
        assert prepared(untold(record)).integrating is None


def test_a_pv_that_stands_after_its_first_turns_says_nothing():
    t = np.arange(300.0)
    sp = np.where(t % 60 < 30, 40.0, 60.0)
    op = sp + 5.0 * np.sin(t)
    record = LoopRecord.from_arrays(t, pv=np.where(t < 5, 9.0, 0.0), op=op, sp=sp, name="X1")
    assert prepared(record).integrating is None  # neither model has anything to explain
