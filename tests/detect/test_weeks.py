"""A record of a week: its days are pooled, so that a weak stick of every day is found and one odd day is not."""

import numpy as np
import pytest
from stickslip.detect import diagnose
from stickslip.detect.judge.answer import answer
from stickslip.detect.judge.over_days import answer_over_days
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.days import DAY_S, SAMPLES_MIN, days_of, edges_of_days
from stickslip.logs import LoopRecord
from stickslip.scan.judge import row_of

from .likelihood.loops import run

EVERY, N = 120.0, 720  # s and samples a day


def week(S, noise=0.16, mv=False):
    """A week of one loop, S [%] of each day, by the plain recursions of the tests of the likelihood."""
    parts = [run(S=one, noise=noise, n=N, seed=200 + day) for day, one in enumerate(S)]
    op, pv = (np.concatenate([part[k] for part in parts]) for k in (0, 1))
    stem = {"mv": op.copy()} if mv else {}
    return LoopRecord.from_arrays(EVERY * np.arange(len(op)), pv=pv, op=op, op_span=(0, 100), name="FIC12", **stem)


WEAK, ODD, SOUND = [1.6] * 7, [0, 0, 0, 2.5, 0, 0, 0], [0] * 7


@pytest.fixture(scope="module")
def weak():
    return week(WEAK)


def test_a_weak_stick_of_every_day_is_found_by_the_week(weak):
    found = answer_over_days(Prepared(weak))
    own = [answer(Prepared(day)) for day in days_of(weak)]
    assert found.word == "stiction" and sum(one.word == "stiction" for one in own) < len(own)
    assert found.picture == "dead_travel" and found.because[0].startswith("Of all days together: "), (
        "what the sum decides"
    )
    assert found.probability > np.median([one.probability for one in own])
    assert found.S.low < 1.6 < found.S.high
    assert found.reason.startswith("7 days of one valve, by themselves")


def test_one_odd_day_convicts_nobody():
    record = week(ODD, noise=0.08)
    own = [answer(Prepared(day)).word for day in days_of(record)]
    assert own[3] == "stiction"  # that day by itself
    found = answer_over_days(Prepared(record))
    assert found.word == "inconclusive" and found.probability < 0.2  # and does not clear the valve, either


def test_a_sound_week_is_not_accused_and_states_what_it_excludes():
    record = week(SOUND, noise=0.08)
    found = answer_over_days(Prepared(record))
    own = [answer(Prepared(day)).probability for day in days_of(record)]
    assert found.probability < 0.1 * np.median(own)  # what no day excludes alone, all of them do
    assert found.word == "no_stiction" and found.limit is not None and 0.5 < found.limit[0] < 1.5


def test_check_and_scan_say_the_same_of_a_week(weak):
    found = answer_over_days(Prepared(weak))
    alone, row = diagnose(weak, []), row_of(weak)
    assert alone.verdict == row["verdict"] == found.word
    assert alone.probability == row["probability"] == found.probability


def test_a_week_whose_stem_is_logged_is_judged_by_it():
    record = week(WEAK, mv=True)
    assert answer_over_days(Prepared(record)).word == answer(Prepared(record)).word == "no_stiction"


def test_a_record_of_a_day_is_judged_as_it_is():
    op, pv = run(S=2.0, n=700)
    record = LoopRecord.from_arrays(60.0 * np.arange(700), pv=pv, op=op, op_span=(0, 100))
    assert days_of(record) == [] and answer_over_days(Prepared(record)) == answer(Prepared(record))


def test_a_window_holds_enough_samples_and_periods():
    t = np.arange(0.0, 20 * DAY_S, 1200.0)  # 72 samples a day
    record = LoopRecord.from_arrays(t, pv=t, op=t)
    assert edges_of_days(record)[1] == 5 and all(
        len(part) >= SAMPLES_MIN for part in days_of(record)
    )  # analytic: 300 / 72
    assert edges_of_days(record, period=DAY_S)[1] == 8  # eight periods


def test_causes_of_several_records_are_told_by_their_probability(weak):
    from stickslip.detect.judge.answer import Answer
    from stickslip.detect.judge.pooled import pooled

    loops = [Prepared(day) for day in days_of(weak)[:2]]
    told = [
        {"healthy": 0.9, "tight_tuning": 0.06, "stiction": 0.04},
        {"stiction": 0.5, "healthy": 0.4, "tight_tuning": 0.1},
    ]
    answers = [Answer("inconclusive", c["stiction"], c, None, None, None, "", "") for c in told]
    causes = list(pooled(loops, answers[::-1] + answers[:1], None).causes.values())
    assert causes == sorted(causes, reverse=True)
