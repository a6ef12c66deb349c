"""A record is judged the same however much of the same comes before it: a long one is cut, not thinned."""

import numpy as np
import pytest
from stickslip.cases.stories import EXPORTS
from stickslip.detect import diagnose
from stickslip.detect.evidence import over_time
from stickslip.detect.judge.answer import answer
from stickslip.detect.prepare.prepared import STEPS_MAX, Prepared
from stickslip.detect.stem.recent import recent
from stickslip.logs import LoopRecord, read_loop


def repeated(record, times):
    t = np.arange(times * len(record)) * record.dt
    parts = {name: np.tile(x, times) for name, x in (("pv", record.pv), ("op", record.op), ("sp", record.sp))}
    return LoopRecord.from_arrays(t, **parts, name=record.name, process=record.process)


@pytest.fixture(scope="module")
def sticky():
    record = read_loop(EXPORTS / "FIC101_pi_export.csv")
    return repeated(record, 1)


def test_the_same_over_and_over_is_judged_as_once(sticky):
    once = answer(Prepared(sticky))
    assert once.word == "stiction"
    longest = -(-200_000 // len(sticky))
    for times in (-(-3 * STEPS_MAX // len(sticky)), longest):
        found = answer(Prepared(repeated(sticky, times)))
        assert found.word == "stiction"
        # invariant: the same cycles have the same stick, within what a single record leaves open
        assert once.S.low <= found.S.value <= once.S.high


def test_that_the_last_part_was_looked_at_is_said(sticky):
    few, many = diagnose(sticky), diagnose(repeated(sticky, -(-50_000 // len(sticky))))
    assert not any("The answer looks at" in said for said in few.assumptions)
    assert any("The answer looks at" in said and "over time" in said for said in many.assumptions)


def test_days_of_a_fast_loop_are_judged_each(sticky):
    fast = repeated(sticky, -(-150_000 // len(sticky)))
    fast = LoopRecord.from_arrays(np.arange(len(fast)) * 2.0, pv=fast.pv, op=fast.op, sp=fast.sp, process=fast.process)
    found = over_time(fast)  # three and a half days, one sample every 2 s
    assert len(found.windows) == 4 and {w.verdict for w in found.windows} == {"stiction"}


@pytest.mark.parametrize("period", [8.0, 50.0, 800.0, 5000.0])
def test_enough_turns_are_left_and_no_more_than_that(period):
    n, most = 400_000, 5000
    wave = np.sin(2.0 * np.pi * np.arange(n) / period)
    left = n - recent(wave, most)
    assert left == most or 20.0 * period <= left <= 45.0 * period  # analytic: 40 turns are 20 periods
    assert n - recent(wave, most, 2.0 * period) >= min(n, 40.0 * period)


def test_a_signal_that_never_turns_is_seen_whole():
    assert recent(np.linspace(0.0, 1.0, 50_000), 5000) == 0 and recent(np.zeros(50_000), 5000) == 0


def test_no_gap_is_spoken_of_where_there_is_none(sticky):
    found = answer(Prepared(repeated(sticky, -(-50_000 // len(sticky)))))
    (said,) = [one for one in found.assumptions if "The answer looks at" in one]
    assert "gap" not in said and said.startswith("The answer looks at the last ")
