"""Detectors, ``diagnose`` and ``compare`` take frames of pandas, polars and pyarrow as they take records."""

import numpy as np
import pytest
from stickslip.detect import METHODS, compare, diagnose
from stickslip.logs import LoopRecord, ReadError, read_loop

N = 900


@pytest.fixture(scope="module")
def columns():
    t = np.arange(N) * 2.0
    return {
        "time": t, "FIC1.PV": np.sin(t / 12) + 0.01 * np.cos(7 * t), "FIC1.OP": 50 + 3 * np.cos(t / 12),
        "FIC1.SP": np.zeros(N),
    }  # fmt: skip


@pytest.fixture(params=["pandas", "polars", "pyarrow"])
def frame(request, columns):
    library = pytest.importorskip(request.param)
    return library.table(columns) if request.param == "pyarrow" else library.DataFrame(columns)


@pytest.fixture(scope="module")
def record(columns):
    return read_loop(pytest.importorskip("polars").DataFrame(columns))


def test_every_method_takes_a_frame(frame, record):
    for method in METHODS:
        of_frame, of_record = method.detect(frame), method.detect(record)
        assert of_frame.to_dict() == of_record.to_dict(), method.CARD.name


def test_diagnose_takes_a_frame(frame, record):
    found, plain = diagnose(frame), diagnose(record)
    assert (found.loop, found.verdict, found.probability) == (plain.loop, plain.verdict, plain.probability)
    # analytic: the period that the record was made with, 2 pi 12 s
    assert found.period == plain.period == pytest.approx(2 * np.pi * 12, rel=0.02)
    assert found.amplitude == pytest.approx(1.0, rel=0.02)


def test_compare_takes_frames_of_one_loop_and_of_several(frame, columns):
    from stickslip.detect.methods import area_ratio

    assert [judged.loop for judged in compare(frame, [area_ratio]).loops] == ["FIC1"]
    both = {**columns, "LIC2.PV": columns["FIC1.PV"], "LIC2.OP": columns["FIC1.OP"]}
    two = pytest.importorskip("polars").DataFrame(both)
    assert [judged.loop for judged in compare([frame, two], [area_ratio]).loops] == ["FIC1", "FIC1", "LIC2"]


@pytest.mark.parametrize("given", [5, None, "FIC1.csv", [1.0, 2.0], np.zeros((3, 3))])
def test_what_is_no_loop_is_refused(given):
    with pytest.raises(TypeError, match="is no loop; give a LoopRecord, or a frame"):
        diagnose(given)


def test_a_frame_without_a_loop_is_refused():
    with pytest.raises(ReadError, match="polars frame: no column is plainly the PV"):
        diagnose(pytest.importorskip("polars").DataFrame({"time": [0.0, 1.0], "x": [1.0, 2.0], "OP": [1.0, 2.0]}))


def test_a_record_is_still_a_record(record):
    assert isinstance(record, LoopRecord) and diagnose(record).loop == "FIC1"
