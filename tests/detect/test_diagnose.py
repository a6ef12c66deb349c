import importlib
import json
import pickle
import types

import numpy as np
import pytest
from stickslip.detect import Card, Method, Verdict, diagnose
from stickslip.detect.methods import area_ratio
from stickslip.logs import LoopRecord


def saying(word, name="area_ratio", code=None):
    index = None if code else 1.0
    v = Verdict(name, word, index, 1.25, f"Because of {word}.", code=code)
    return types.SimpleNamespace(detect=lambda record: v)


@pytest.fixture
def record(wave, loop):
    t = np.arange(500.0)
    return loop(t, wave("sine", t))


KEYS = [
    "schema", "loop", "verdict", "probability", "period_s", "amplitude", "causes", "amount", "detection_limit",
    "reason", "because", "action", "assumptions", "methods",
]  # fmt: skip


def test_schema(record):
    answer = diagnose(record).to_dict()
    assert list(answer) == KEYS
    assert answer["schema"] == "stickslip.check/2"
    assert {"name", "verdict", "index", "threshold", "reason"} <= set(answer["methods"][0])
    assert 0.0 <= answer["probability"] <= 1.0
    assert answer["causes"]["stiction"] == answer["probability"]
    assert sum(answer["causes"].values()) == pytest.approx(1.0)
    assert any("calibrated on simulated loops" in text for text in answer["assumptions"])


def test_methods_that_are_given_stand_beside_one_verdict(record):
    alone, beside = diagnose(record), diagnose(record, [saying("stiction")])
    assert (beside.verdict, beside.probability, beside.because) == (alone.verdict, alone.probability, alone.because)
    assert [v.verdict for v in beside.methods] == ["stiction"]


def test_json_is_strict_even_for_a_hopeless_record():
    t = np.arange(3.0)
    hopeless = LoopRecord.from_arrays(t, pv=[np.nan, 1, 1], op=[1, np.nan, 1])
    text = json.dumps(diagnose(hopeless).to_dict(), allow_nan=False)
    assert json.loads(text)["verdict"] == "not_applicable"


def test_methods_are_counted_beside_the_verdict_and_refusals_are_not(record):
    said = [saying(word) for word in ("stiction", "stiction", "no_stiction")]
    refusing = saying("not_applicable", code="quantised")
    alone, answer = diagnose(record, []), diagnose(record, [*said, refusing])
    assert (answer.verdict, answer.probability) == (alone.verdict, alone.probability)
    assert "Of 3 methods that could look" in answer.reason and "(area_ratio, area_ratio)" in answer.reason
    assert "could look" not in diagnose(record, [refusing]).reason


def test_reason_has_the_numbers(wave, loop):
    t = np.arange(1000.0)
    said = area_ratio.detect(loop(t, wave("exponential", t)))
    for piece in ("as after a slip", "R = 5", "90 % interval", "period 50", "half cycles"):
        assert piece in said.reason


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
    (answer,) = diagnose(make(t, np.sin(t / 8)), [area_ratio]).methods
    assert answer.verdict == "not_applicable"
    assert piece in answer.reason


def test_missing_set_point_is_an_assumption(wave):
    t = np.arange(800.0)
    answer = diagnose(LoopRecord.from_arrays(t, pv=wave("sine", t), op=50 + np.sin(t)))
    assert any("mean of PV" in text for text in answer.assumptions)


# ---- methods from outside the package ----------------------------------------------------------------------


def outside(word="stiction", experimental=False, **more):
    """A detector that no module of this package knows."""
    card = Card("mine", "Mine", "nobody", ("PV",), ("none",), "nothing", (0, 9), ("self_regulating",), "no",
                experimental=experimental)  # fmt: skip

    def detect(record):
        return Verdict("mine", word, 2.0, 1.0, "Seen so.", evidence={"x": np.arange(4.0)})

    return types.SimpleNamespace(CARD=card, detect=detect, **more)


def draw_mine(v, figure):
    figure.subplots().plot(v.array("x"), label="drawn by mine")


def drawn(figure):
    figure.canvas.draw()
    return [line.get_label() for axes in figure.axes for line in axes.lines]


def test_a_method_from_outside_is_used_and_plotted(record):
    answer = diagnose(record, [outside(draw=draw_mine)])
    assert "drawn by mine" in drawn(answer.methods[0].plot())
    assert "Of 1 method that could look" in answer.reason and "(mine)" in answer.reason


def test_a_module_from_outside_is_used_and_plotted(record, tmp_path, monkeypatch):
    (tmp_path / "house_method.py").write_text(
        "from stickslip.detect import Card, Verdict\n"
        "CARD = Card('house_method', 'House', 'us', ('PV',), (), 'x', (0, 9), ('self_regulating',), 'no')\n"
        "def detect(record):\n"
        "    return Verdict('house_method', 'inconclusive', 1.0, 2.0, 'Unsure.', evidence={'R': 1.0}, draw=draw)\n"
        "def draw(v, figure):\n"
        "    figure.subplots().plot([0, 1], label='drawn by the house')\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    mine = importlib.import_module("house_method")
    answer = diagnose(record, [mine])
    assert "drawn by the house" in drawn(answer.methods[0].plot())
    assert "drawn by the house" in drawn(mine.detect(record).plot())
    assert isinstance(mine, Method)
    assert pickle.loads(pickle.dumps(answer.methods[0])).draw is mine.draw


def test_a_method_without_a_picture_shows_its_words(record):
    answer = diagnose(record, [outside()])
    assert not [label for label in drawn(answer.plot()) if label == "drawn by mine"]
    figure = answer.methods[0].plot()
    figure.canvas.draw()
    assert "Seen so." in [text.get_text() for axes in figure.axes for text in axes.texts]


def test_an_experimental_method_is_marked(wave, loop):
    t = np.arange(1000.0)
    record = loop(t, wave("exponential", t))
    answer = diagnose(record, [area_ratio, outside("no_stiction", experimental=True, draw=draw_mine)])
    assert [method["experimental"] for method in answer.to_dict()["methods"]] == [False, True]
    assert "on trial" in answer.methods[1].plot().get_suptitle()
    assert answer.verdict == diagnose(record, []).verdict


@pytest.mark.parametrize(
    "method, words",
    [(np, r"no function detect.*area_ratio"), (types.SimpleNamespace(detect=lambda record: 3), "gave 3.*Verdict")],
)
def test_what_is_no_method_is_refused(record, method, words):
    with pytest.raises(TypeError, match=words):
        diagnose(record, [method])


def test_picture(record):
    figure = diagnose(record).plot()
    figure.canvas.draw()
    assert sum(len(part.axes) for part in figure.subfigs) == 5


def test_a_constant_output_is_not_taken_to_be_in_automatic(record):
    still = LoopRecord.from_arrays(record.t, pv=record.pv, op=0 * record.t + 48.3, sp=0 * record.t)
    answer = diagnose(still, methods=[])
    assert "the loop is in manual or OP is frozen" in answer.reason
    assert not any("in automatic" in said for said in answer.assumptions)
    assert any("in automatic" in said for said in diagnose(record, methods=[]).assumptions)


def test_two_days_of_three_dates_are_no_three_days():
    from datetime import datetime

    from stickslip.logs import Log

    t = np.arange(0.0, 48 * 3600.0, 60.0)
    rng = np.random.default_rng(1)
    op = 50 + 5 * np.sin(t / 900) + np.sin(t / 4000)
    pv = np.concatenate([[50.0], op[:-1]]) + 0.1 * rng.normal(size=len(t))
    log = Log(t, {"PV": pv, "OP": op}, spans={"OP": (0, 100)}, start=datetime(2025, 3, 11, 6))
    said = diagnose(log.loop(), methods=[]).reason
    assert "3 days" not in said and "3 calendar days of one valve" in said
