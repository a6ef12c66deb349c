"""The variants of a record that a word must survive, and how a change of it is counted."""

import numpy as np
import pytest
from stickslip.logs import LoopRecord

from benchmarks.stability import CROPS, VARIANTS, figures, variants

N = 1000


@pytest.fixture
def made():
    t, rng = np.arange(float(N)), np.random.default_rng(1)
    record = LoopRecord.from_arrays(t, pv=10 * rng.random(N), op=t, op_span=(0, 200), name="FIC1")
    return dict(variants(record))


def test_the_variants_are_what_they_say(made):  # analytic: shares of 1,000 rows
    assert set(made) == {"", *VARIANTS}
    assert [len(made[f"first {share} %"]) for share in (70, 80, 90)] == [700, 800, 900]
    assert made["last 70 %"].op[0] == pytest.approx(300.0, abs=1.0)
    assert made["every second sample"].op.tolist() == made[""].op[::2].tolist()
    assert np.std(made["1 % noise"].pv - made[""].pv) == pytest.approx(0.01 * 9.0, rel=0.1)  # nine tenths of 10
    assert all(one.log.spans[one.op_name] == (0, 200) for one in made.values())


def row(real, word, words, p=0.5):
    word_of = dict.fromkeys(VARIANTS, word) | words
    return {"key": "a", "real": real, "kind": "sticks", "word ": word, "p ": p} | {
        f"{what} {v}": value for v in VARIANTS for what, value in (("word", word_of[v]), ("p", p))
    }


def test_changes_are_counted_by_what_they_are():  # analytic: eight variants of two records
    rows = [
        row(True, "stiction", {"1 % noise": "no_stiction", "every second sample": "inconclusive"}),
        row(True, "inconclusive", {next(iter(CROPS)): "stiction"}),
        row(True, "not_applicable", {}),  # nothing was said
    ]
    found = figures(rows)
    n = 2 * len(VARIANTS)
    assert found["real_turned"] == 1 / n and found["real_changed"] == 3 / n
    assert found["real_given_up"] == 1 / n and found["real_taken_up"] == 1 / n
    assert found["real_changed: 1 % noise"] == 0.5
