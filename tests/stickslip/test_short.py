"""Records too short for any verdict end with exit code 2 in every command; beside a longer one they do no harm."""

import numpy as np
import pytest


def written(path, rows):
    """Write a loop that oscillates, one row a second."""
    t = np.arange(rows)
    lines = [f"{k},{50 + np.sin(k / 3):.6f},{45 + 2 * np.cos(k / 3):.6f}" for k in t.tolist()]
    path.write_text("\n".join(["time,PV,OP", *lines]) + "\n")
    return path


@pytest.mark.parametrize("command", ["check", "table"])
@pytest.mark.parametrize("rows", [2, 50])
def test_one_that_nothing_can_judge_is_bad_input(call, tmp_path, command, rows):
    done = call(command, written(tmp_path / "FIC1.csv", rows))
    assert done.exit_code == 2
    assert f"FIC1: {rows} rows, of which no method can say anything; give 100 rows or more" in done.stderr


def test_check_tells_what_it_has_read_all_the_same(call, tmp_path):
    done = call("check", written(tmp_path / "FIC1.csv", 50))
    assert "NOT APPLICABLE" in done.stdout and "50 samples" in " ".join(done.stdout.split())


@pytest.mark.parametrize("command", ["check", "table"])
def test_several_such_are_bad_input_together_and_one_beside_a_longer_is_not(call, tmp_path, command):
    short = [written(tmp_path / f"FIC{rows}.csv", rows) for rows in (2, 50)]
    done = call(command, *short)
    assert done.exit_code == 2 and "FIC2, FIC50: 50 rows" in done.stderr
    assert call(command, *short, written(tmp_path / "long.csv", 300)).exit_code in (0, 1)
