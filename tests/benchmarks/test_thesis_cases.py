"""The thesis's plant cases: logs without stems, counts that add up."""

from benchmarks.thesis_cases import STICKY, Cell, First, figures, logs_of, notes, plant_of


def test_starts_differ_and_stems_are_left_out():
    first, second = logs_of("constant", "high", 2)
    assert abs(first["p_1"] - second["p_1"]).max() > 1.0
    assert not any(name.startswith("MV_") for name in first.names) and first.loops["PCS11"].mv is None
    assert next(logs_of("sine", "none", 1, stem=True)).loops["LCS11"].mv == "MV_VLCS1"


def test_feeds_differ():
    names = {kind: {block.name for block in plant_of(kind, "high").blocks} for kind in ("constant", "slugs")}
    assert plant_of("constant", "high")["F_in"].__class__ is not plant_of("slugs", "high")["F_in"].__class__
    assert len(names["constant"]) == len(names["slugs"])


def test_counts():
    sticky, sound = Cell("sine", "high", "level"), Cell("sine", "none", "level")
    for cell in (sticky, sound):
        cell.words.update(["stiction"] * 3 + ["inconclusive"])
        cell.thesis_sticky = 1
    assert (sticky.right, sticky.thesis_right, sticky.starts) == (3, 1, 4)
    assert (sound.right, sound.thesis_right) == (1, 3)
    first = First("constant", "high")
    first.add(next(logs_of("constant", "high", 1)), STICKY)
    assert (first.starts, first.first) == (1, 1)
    found = figures([sticky, sound], [first])
    assert found["cells"] == 2.0 and found["sine_high_level_right"] == 0.75 and found["cells_right"] == 0.0
    assert set(found) == set(notes([sticky, sound], [first]))
