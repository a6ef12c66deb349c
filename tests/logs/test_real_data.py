"""The real records read with the notes an engineer would expect."""

import csv

import numpy as np
import pytest
from stickslip.logs import read_log, read_loop


def rows(folder):
    with (folder / "loops.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_every_loop_reads(real_data):
    seen = 0
    for row in rows(real_data):
        loop = read_loop(real_data / row["file"])
        seen += 1
        assert loop.dt == float(row["sampling_s"]), row["loop"]  # published: the table beside the data
        assert loop.good.all(), row["loop"]
        assert len(loop.segments()) == 1, row["loop"]
        isdb = row["file"].startswith("isdb")
        assert (loop.sp is None) == isdb
        # Published: these were standardised by their contributors, the others are in %.
        assert (loop.op_percent is None) == (row["loop"] in {"CHEM10", "CHEM12", "CHEM13"}), row["loop"]
        if isdb:  # the file name is no tag
            assert loop.process == "unknown"
        else:
            assert loop.measurement == row["measurement"]
            assert (loop.process == "integrating") == (row["integrating"] == "true")
    assert seen == 32


def test_numbers_are_those_of_the_file(real_data):
    path = real_data / "isdb" / "CHEM1.csv"
    expected = np.loadtxt(path, delimiter=",", skiprows=1)  # an independent parser
    loop = read_loop(path)
    assert np.array_equal(np.column_stack([loop.t, loop.op, loop.pv]), expected)


def test_measured_stem(real_data):
    loop = read_loop(real_data / "damadics" / "first_half.csv")
    assert "'stem' is read as MV." in loop.notes
    assert loop.mv[0] == 68.3  # published: first row of the file
    assert len(read_log(real_data / "damadics" / "first_half.csv").names) == 10


def test_quoted_header(real_data):
    assert read_log(real_data / "labvolt" / "training_set.csv").names == ("input", "output")


@pytest.mark.parametrize("name", ["isdb/CHEM13.csv", "refinery/LIC30501_20241018_2155.csv"])
def test_round_trip(real_data, tmp_path, name):
    loop = read_loop(real_data / name)
    loop.log.to_csv(tmp_path / "again.csv")
    again = read_loop(tmp_path / "again.csv", name=loop.name, process=loop.process)
    assert np.array_equal(again.pv, loop.pv)
    assert np.array_equal(again.op, loop.op)
    assert again.log.spans == loop.log.spans
    assert again.notes == loop.notes
