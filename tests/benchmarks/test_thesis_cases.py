"""The thesis's plant cases: logs without stems, counts that add up."""

import pytest
from stickslip.detect.judge.answer import answer
from stickslip.detect.prepare.prepared import Prepared

from benchmarks.thesis_cases import STICKY, Cell, First, figures, logs_of, notes, plant_of, without_stems


def test_starts_differ_and_stems_are_left_out():
    first, second = logs_of("constant", "high", 2)
    assert abs(first["p_1"] - second["p_1"]).max() > 1.0
    assert first.loops["LCS11"].mv == "MV_VLCS1"
    blind = without_stems(first)
    assert not any(name.startswith("MV_") for name in blind.names) and blind.loops["PCS11"].mv is None


@pytest.mark.parametrize("size, J", [("none", 0.0), ("normal", 0.95), ("high", 1.9)])
def test_the_stem_answers_though_op_saturates(size, J):
    """Under the sine the compressor's feed drives VPCS1 to its limit for a third of the time; the valve is judged.

    J is (F_s - F_c) / k, (published: 0, 1 and 2 % of the stroke).
    """
    found = answer(Prepared(next(logs_of("sine", size, 1)).loop(name="PCS11")))
    assert found.word == ("no_stiction" if size == "none" else "stiction"), found.reason
    if found.J is not None:
        assert found.J.value == pytest.approx(J, rel=0.3) and found.S.value == pytest.approx(4.76 + J, rel=0.1)


def test_feeds_differ():
    names = {kind: {block.name for block in plant_of(kind, "high").blocks} for kind in ("constant", "slugs")}
    assert plant_of("constant", "high")["F_in"].__class__ is not plant_of("slugs", "high")["F_in"].__class__
    assert len(names["constant"]) == len(names["slugs"])


def test_counts():
    sticky, sound = Cell("sine", "high", "level"), Cell("sine", "none", "level")
    for cell in (sticky, sound):
        cell.words.update(["stiction"] * 3 + ["inconclusive"])
        cell.blind.update(["inconclusive"] * 4)
        cell.tags.update(["stiction"] * 4)
        cell.thesis_sticky = 1
    assert (sticky.right, sticky.thesis_right, sticky.starts) == (3, 1, 4)
    assert (sound.right, sound.thesis_right) == (1, 3)
    assert (sticky.blind_right, sound.blind_right) == (0, 4)
    assert (sticky.tags_right, sound.tags_right) == (4, 0)
    first = First("constant", "high")
    first.add(next(logs_of("constant", "high", 1)), STICKY)
    assert (first.starts, first.first) == (1, 1)
    found = figures([sticky, sound], [first])
    assert found["cells"] == 2.0 and found["sine_high_level_right"] == 0.75 and found["cells_right"] == 0.0
    assert found["cells_right_without_stem"] == found["cells_right_of_tags"] == 1.0
    assert set(found) == set(notes([sticky, sound], [first]))
