"""All methods side by side: each row is what the method says alone, and no cell runs as a formula."""

import csv
import io
import json
import types

import numpy as np
import pytest
from stickslip.detect import METHODS, Comparison, Verdict, compare, diagnose
from stickslip.detect.cards import CARD_COLUMNS, card_rows
from stickslip.detect.comparison import COLUMNS, harmless
from stickslip.detect.methods import area_ratio, cross_correlation
from stickslip.logs import Log, LogError, LoopRecord, ReadError


@pytest.fixture
def record(wave, loop):
    t = np.arange(600.0)
    return loop(t, wave("exponential", t))


def test_every_method_says_what_it_says_alone(record):
    found = compare(record)
    (judged,) = found.loops
    assert [v.method for v in judged.verdicts] == [method.CARD.name for method in METHODS]
    for method, v in zip(METHODS, judged.verdicts, strict=True):
        alone = method.detect(record)
        assert (v.verdict, v.index, v.reason) == (alone.verdict, alone.index, alone.reason), v.method
    assert judged.combined == diagnose(record).verdict
    assert judged.samples == 600 and judged.preparation > 0.0 and min(judged.milliseconds) > 0.0
    assert all(len(row) == len(COLUMNS) for row in found.rows())
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["schema"] == "stickslip.table/1"


def test_the_time_of_a_method_is_its_own(record):
    import time

    def slow(loop):
        time.sleep(0.05)
        return Verdict("slow", "inconclusive", None, None, "Waited.")

    (judged,) = compare(record, [types.SimpleNamespace(detect=slow), area_ratio]).loops
    assert 50.0 <= judged.milliseconds[0] < 1000.0
    assert judged.milliseconds[0] > judged.milliseconds[1]


def test_what_can_be_compared(record, tmp_path):
    methods = [area_ratio, cross_correlation]
    log = Log(t=record.t, signals={"SP": record.sp, "PV": record.pv, "OP": record.op})
    log.to_csv(tmp_path / "b.csv")
    (tmp_path / "a.csv").write_text("nonsense")
    (tmp_path / "c.pdf").write_text("not a record")
    case = types.SimpleNamespace(loop_records=lambda: (record,))
    for one in (record, log, case, tmp_path / "b.csv", str(tmp_path / "b.csv"), tmp_path):
        (judged,) = compare(one, methods).loops
        assert judged.verdicts[0].index == pytest.approx(area_ratio.detect(record).index)
    folder = compare(tmp_path, methods)
    assert [file for file, _ in folder.skipped] == ["a.csv"] and folder.to_dict()["skipped"][0]["reason"]
    assert len(compare([record, tmp_path / "b.csv"], methods).loops) == 2


def test_what_cannot(tmp_path):
    with pytest.raises(ReadError, match="holds no loop that can be read"):
        compare(tmp_path)
    with pytest.raises(ReadError):
        compare(tmp_path / "missing.csv")
    with pytest.raises(ReadError, match="no loop is given"):
        compare([])
    with pytest.raises(TypeError, match="int is no loop; give a LoopRecord"):
        compare(3)
    with pytest.raises(LogError):
        compare(Log(t=[0, 1], signals={"x": [1, 2]}))


@pytest.mark.parametrize("text", ['=HYPERLINK("x")', "+1+1", "-1+1", "@SUM(A1)", "\t=1", " =1", "\r=1"])
def test_no_cell_is_a_formula(text):
    assert harmless(text) == f"'{text}"
    record = LoopRecord.from_arrays(np.arange(9.0), pv=np.arange(9.0), op=np.arange(9.0), name=text)
    said = Verdict("m", "inconclusive", -0.5, 1.0, f"{text}")
    found = compare(record, [types.SimpleNamespace(detect=lambda loop: said)])
    _, cells = csv.reader(io.StringIO(found.csv(), newline=""))
    assert cells[COLUMNS.index("loop")] == f"'{text}" and cells[COLUMNS.index("reason")] == f"'{text}"
    assert float(cells[COLUMNS.index("index")]) == -0.5


@pytest.mark.parametrize("text", ["-0.5", "+3", "-", "FIC1", "", "-1e-3"])
def test_numbers_and_words_stay(text):
    assert harmless(text) == text


def test_picture(record):
    found = compare([record, record], [area_ratio, cross_correlation])
    figure = found.plot()
    figure.canvas.draw()
    cells, bars = figure.axes
    assert len(cells.patches) == 2 * 3 and len(bars.patches) == 2
    assert isinstance(found, Comparison)
    assert cells.texts[0].get_text() == "S"


def test_cards_are_complete():
    rows = card_rows()
    assert [row[0] for row in rows] == [method.CARD.name for method in METHODS]
    for row in rows:
        assert len(row) == len(CARD_COLUMNS) and all(row), row[0]
