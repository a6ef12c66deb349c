import json
import types

import numpy as np
import pytest

from detect import Verdict, diagnose
from records import LoopRecord


def saying(word, name="area_ratio", code=None):
    index = None if code else 1.0
    v = Verdict(name, word, index, 1.25, f"Because of {word}.", code=code)
    return types.SimpleNamespace(detect=lambda record: v)


@pytest.fixture
def record(wave, loop):
    t = np.arange(500.0)
    return loop(t, wave("sine", t))


def test_schema(record):
    answer = diagnose(record).to_dict()
    assert list(answer) == ["schema", "loop", "verdict", "probability", "reason", "assumptions", "methods"]
    assert answer["schema"] == "stickslip.check/1"
    assert {"name", "verdict", "index", "threshold", "reason"} <= set(answer["methods"][0])
    assert answer["probability"] is None
    assert any("calibrated" in text for text in answer["assumptions"])


def test_json_is_strict_even_for_a_hopeless_record():
    t = np.arange(3.0)
    hopeless = LoopRecord.from_arrays(t, pv=[np.nan, 1, 1], op=[1, np.nan, 1])
    text = json.dumps(diagnose(hopeless).to_dict(), allow_nan=False)
    assert json.loads(text)["verdict"] == "not_applicable"


@pytest.mark.parametrize(
    "said, together",
    [
        (["stiction"], "stiction"),
        (["stiction", "inconclusive"], "stiction"),
        (["stiction", "no_stiction"], "inconclusive"),
        (["inconclusive", "no_stiction"], "no_stiction"),
        (["inconclusive"], "inconclusive"),
        ([], "not_applicable"),
    ],
)
def test_methods_are_put_together(record, said, together):
    assert diagnose(record, [saying(word) for word in said]).verdict == together


def test_refusals_do_not_vote(record):
    refusing = saying("not_applicable", code="quantised")
    assert diagnose(record, [refusing, saying("stiction")]).verdict == "stiction"
    assert diagnose(record, [refusing]).verdict == "not_applicable"


def test_reason_has_the_numbers_and_the_next_step(wave, loop):
    t = np.arange(1000.0)
    reason = diagnose(loop(t, wave("exponential", t))).reason
    for piece in ("sticky", "R = 5", "90 % interval", "period 50", "half cycles", "To prove it"):
        assert piece in reason


@pytest.mark.parametrize(
    "make, piece",
    [
        (lambda t, e: LoopRecord.from_arrays(t, pv=e, op=50 + e, process="integrating"), "integrates"),
        (lambda t, e: LoopRecord.from_arrays(t, pv=e, op=50 + e, name="LIC106"), "integrates"),
        (lambda t, e: LoopRecord.from_arrays(t[:3], pv=e[:3], op=50 + e[:3]), "3 samples"),
        (lambda t, e: LoopRecord.from_arrays(t, pv=0 * e + 4, op=50 + e), "PV stays at 4"),
        (lambda t, e: LoopRecord.from_arrays(t, pv=e, op=0 * e + 50), "OP stays at 50"),
        (lambda t, e: LoopRecord.from_arrays(t, pv=e, op=np.where(e > 0, 0.0, 50.0)), "end of its span"),
    ],
)
def test_refusals_in_plain_words(make, piece):
    t = np.arange(800.0)
    answer = diagnose(make(t, np.sin(t / 8)))
    assert answer.verdict == "not_applicable"
    assert piece in answer.reason


def test_missing_set_point_is_an_assumption(wave):
    t = np.arange(800.0)
    answer = diagnose(LoopRecord.from_arrays(t, pv=wave("sine", t), op=50 + np.sin(t)))
    assert any("mean of PV" in text for text in answer.assumptions)


def test_picture(record):
    figure = diagnose(record).plot()
    figure.canvas.draw()
    assert sum(len(part.axes) for part in figure.subfigs) == 5
