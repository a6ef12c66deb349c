"""Many loops from one file in one read: each as `read_loop` gives it alone."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.logs import ReadError, read_loop, read_loops

TAGS = ("FIC101", "LIC202", "PIC303")


@pytest.fixture
def unit(tmp_path):
    """An export of three loops, with a stem position, a quality column of none and a comment."""
    rng = np.random.default_rng(5)
    names = [f"{tag}.{part}" for tag in TAGS for part in ("SP", "PV", "OP")] + ["ZT303.PV", "TI9.PV"]
    rows = np.round(50 + 10 * rng.normal(size=(40, len(names))).clip(-3, 3), 3)
    lines = [",".join(["time", *names])] + [",".join([f"{5 * k}", *map(str, row)]) for k, row in enumerate(rows)]
    path = tmp_path / "unit.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_each_loop_is_the_one_that_read_loop_gives(unit):
    for record, tag in zip(read_loops(unit), TAGS, strict=True):
        alone = read_loop(unit, loop=tag)
        assert record.log.names == alone.log.names
        for name in record.log.names:
            np.testing.assert_array_equal(record.log[name], alone.log[name])
        same = ("name", "process", "measurement", "sp_name", "pv_name", "op_name", "mv_name", "mode_name", "op_span")
        assert [getattr(record, part) for part in same] == [getattr(alone, part) for part in same]
        ours = [note for note in record.notes if not note.startswith("Columns not used")]
        assert ours == [note for note in alone.notes if not note.startswith("Columns not used")]


def test_columns_of_the_other_loops_are_not_called_unused(unit):
    for record in read_loops(unit):
        unused = next(note for note in record.notes if note.startswith("Columns not used"))
        assert "TI9.PV" in unused and not any(f"{tag}." in unused for tag in TAGS)


def test_the_file_is_read_once(unit, monkeypatch):
    from stickslip.logs.files import read

    asked = []
    monkeypatch.setattr(read, "file_bytes", lambda source, of=read.file_bytes: asked.append(source) or of(source))
    assert len(read_loops(unit)) == len(TAGS)
    assert asked == [unit]


def test_loops_can_be_named(unit):
    assert [record.name for record in read_loops(unit, loops=["PIC303", "FIC101"])] == ["PIC303", "FIC101"]
    with pytest.raises(ReadError, match=r"unit.csv: no loop 'XIC1'; the file has 'FIC101', 'LIC202', 'PIC303'"):
        read_loops(unit, loops=["XIC1"])
    with pytest.raises(ReadError, match="loops names no loop"):
        read_loops(unit, loops=[])


def test_a_file_without_tags_is_one_loop(tmp_path):
    path = tmp_path / "trend.csv"
    path.write_text("time,SP,PV,OP\n0,5,4.5,50\n1,5,4.6,51\n2,5,4.7,52\n")
    (record,) = read_loops(path)
    assert record.name == "trend" and replace(record, log=read_loop(path).log).notes == read_loop(path).notes
