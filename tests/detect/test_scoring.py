"""Scores on labelled records: by tag, by the majority of what is decided, counted by hand."""

import pytest
from stickslip.detect.comparison import Comparison, Judged
from stickslip.detect.scoring import SCORE_COLUMNS, Label, read_labels, score_rows, scores
from stickslip.detect.verdict import Verdict
from stickslip.logs import ReadError

WORD = {"S": "stiction", "N": "no_stiction", "?": "inconclusive"}


def judged(name, method, combined):
    said = Verdict("m", WORD[method], 1.0, 1.0, "So.")
    return Judged(name, WORD[combined], (said,), (1.0,), 1.0, 100)


LABELS = {
    "a1": Label("A", True), "a2": Label("A", True), "a3": Label("A", True), "b": Label("B", True),
    "c": Label("C", False), "d1": Label("D", False), "d2": Label("D", False),
}  # fmt: skip
FOUND = Comparison(
    tuple(judged(*row) for row in (("a1", "S", "?"), ("a2", "S", "?"), ("a3", "N", "?"), ("b", "?", "S"),
                                   ("c", "S", "N"), ("d1", "N", "S"), ("d2", "S", "N"), ("none", "S", "S")))
)  # fmt: skip


def test_counted_by_hand():
    method, combined = scores(FOUND, LABELS)
    # m: A sticky by two to one (right), B open, C accused wrongly, D a tie, hence open
    assert (method.sticky, method.others, method.found, method.wrong, method.right, method.open_tags) == (
        2,
        2,
        1,
        1,
        1,
        2,
    )
    # combined: A open, B found, C cleared rightly, D a tie
    assert (combined.found, combined.wrong, combined.right, combined.open_tags) == (1, 0, 2, 2)


def test_rows_have_the_trivial_answer_and_the_published_beside():
    rows = score_rows(scores(FOUND, LABELS))
    assert all(len(row) == len(SCORE_COLUMNS) for row in rows)
    assert [row[0] for row in rows[:3]] == ["m", "combined", "always sticky"]
    assert rows[2][3] == "2 of 4" and any("18 of 20" in row for row in rows[3:])


def test_labels_of_a_file(tmp_path):
    file = tmp_path / "labels.csv"
    file.write_text("loop,label,tag\na1,stiction,A\na2,Sticky,A\nc,tight tuning,\nd,,D\n")
    assert read_labels(file) == {"a1": Label("A", True), "a2": Label("A", True), "c": Label("c", False)}


@pytest.mark.parametrize(
    "text, piece", [("loop,x\na,b\n", "no column 'label'"), ("", "no column 'loop'"), ("loop,label\na,\n", "no label")]
)
def test_labels_that_are_none(tmp_path, text, piece):
    file = tmp_path / "labels.csv"
    file.write_text(text)
    with pytest.raises(ReadError, match=piece):
        read_labels(file)
    with pytest.raises(ReadError, match="missing"):
        read_labels(tmp_path / "missing.csv")


def test_no_loop_with_a_label():
    with pytest.raises(ReadError, match="no loop has a label"):
        scores(FOUND, {"z": Label("Z", True)})
