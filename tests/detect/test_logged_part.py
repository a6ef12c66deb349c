"""A loop that is logged for a part of a file's time is judged by that part, and says so."""

import numpy as np
from stickslip.detect import diagnose
from stickslip.detect.judge.answer import answer
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord


def rarely_logged(record, before, after):
    """The record as a loop of a file that begins long before it and ends long after it."""
    n = len(record)
    t = record.dt * np.arange(before + n + after)
    parts = {}
    for name, x in (("pv", record.pv), ("op", record.op), ("sp", record.sp)):
        parts[name] = np.full(len(t), np.nan)
        parts[name][before : before + n] = x
    return LoopRecord.from_arrays(t, process=record.process, name=record.name, op_span=(0, 100), **parts)


def test_a_piece_is_judged_as_it_is_alone(sticky):
    record = sticky(noise=0.1)
    alone = rarely_logged(record, 0, 0)
    found, own = answer(Prepared(rarely_logged(record, 3 * len(record), 500))), answer(Prepared(alone))
    assert own.word != "not_applicable"
    assert (found.word, found.probability) == (own.word, own.probability)


def test_that_a_piece_was_judged_is_said(sticky):
    record = sticky(noise=0.1)
    found = diagnose(rarely_logged(record, 3 * len(record), 0), methods=[])
    assert found.verdict != "not_applicable"
    (said,) = [one for one in found.assumptions if "judged is one piece" in one]
    assert f"in 25 % of the time; judged is one piece of {len(record)} samples" in said


def test_scattered_samples_are_no_piece(sticky):
    record = sticky(noise=0.1)
    pv = record.pv.copy()
    pv[np.arange(len(pv)) % 4 > 0] = np.nan
    found = diagnose(LoopRecord.from_arrays(record.t, pv=pv, op=record.op, sp=record.sp), methods=[])
    assert found.verdict == "not_applicable" and "missing or bad in 75%" in found.reason
