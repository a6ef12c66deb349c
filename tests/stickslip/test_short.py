"""Records too short for any verdict are bad input of every command, and nothing is written of them."""

import numpy as np
import pytest


def written(path, rows):
    """Write a loop that oscillates, one row a second."""
    t = np.arange(rows)
    lines = [f"{k},{50 + np.sin(k / 3):.6f},{45 + 2 * np.cos(k / 3):.6f}" for k in t.tolist()]
    path.write_text("\n".join(["time,PV,OP", *lines]) + "\n")
    return path


@pytest.mark.parametrize("command", ["check", "table", "scan"])
@pytest.mark.parametrize("rows", [1, 2, 50])
def test_one_that_nothing_can_judge_is_bad_input(call, tmp_path, command, rows):
    page = tmp_path / "page.html"
    done = call(command, written(tmp_path / "FIC1.csv", rows), "--html", page, *out_of(command, tmp_path))
    assert done.exit_code == 2 and done.stdout == ""
    assert f"FIC1: {rows} row" in done.stderr
    assert "of which no method can say anything; give 100 rows or more" in done.stderr
    assert not page.exists()


def out_of(command, folder):
    """Return the option that names the folder of a scan."""
    return ("--out", folder / "out") if command == "scan" else ()


@pytest.mark.parametrize("command", ["check", "table"])
def test_several_such_are_bad_input_together_and_one_beside_a_longer_is_not(call, tmp_path, command):
    short = [written(tmp_path / f"FIC{rows}.csv", rows) for rows in (2, 50)]
    done = call(command, *short)
    assert done.exit_code == 2 and "FIC2, FIC50: 50 rows" in done.stderr
    assert call(command, *short, written(tmp_path / "long.csv", 300)).exit_code in (0, 1)
