"""What a benchmark requires is judged beside the figure, and a quick run says that it judges nothing."""

import importlib
import json

import pytest

from benchmarks import report

NOTES = {
    "fast": "time over C's (required: at most 4)",
    "sure": "ours over theirs (goal: at least 300)",
    "s": "seconds [s]",
}


def test_a_figure_that_misses_says_so(capsys):
    assert report.publish({"fast": 11.3, "sure": 372.0, "s": 0.7}, NOTES, None) is False
    lines = {line.split()[0]: line for line in capsys.readouterr().out.splitlines()}
    assert " MISS " in lines["fast"] and " PASS " in lines["sure"]
    assert "MISS" not in lines["s"] and "PASS" not in lines["s"]
    assert lines["requirements"] == "requirements met: 1 of 2; missed: fast"


def test_a_quick_run_judges_nothing(capsys):
    assert report.publish({"fast": 11.3}, NOTES, None, quick=True) is True
    out = capsys.readouterr().out
    assert "MISS" not in out and "PASS" not in out and "too short to judge" in out


def test_the_json_object_alone_is_judged_too(capsys):
    assert report.publish({"fast": 11.3}, NOTES, "-") is False
    assert json.loads(capsys.readouterr().out) == {"fast": 11.3}


@pytest.mark.parametrize(
    ("value", "note", "met"),
    [
        (4.0, "(required: at most 4)", True), (4.01, "(required: at most 4; measured 3 to 5)", False),
        (1e-6, "(required: below 1e-6)", False), (60.0, "(goal: at most 60 on two)", True),
        (None, "(required: at most 4)", None), (5, "(goal: at least 5)", True), (5.0, "no limit", None),
    ],
)  # fmt: skip
def test_limits(value, note, met):
    assert report.meets(value, note) is met


def test_a_requirement_that_cannot_be_read_is_refused():
    with pytest.raises(ValueError, match="requires something"):
        report.meets(1.0, "speed (goal: 300)")


@pytest.mark.parametrize("name", ["simulate", "plant", "robustness"])
def test_every_requirement_can_be_read(name):
    notes = importlib.import_module(f"benchmarks.{name}").NOTES
    wanted = [note for note in notes.values() if "required" in note or "goal" in note]
    assert wanted and all(report.meets(1.0, note) is not None for note in wanted)
