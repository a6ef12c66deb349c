"""Rounded stamps, repeats, missing rows and files that run from the newest row to the oldest."""

from datetime import datetime

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.logs import ReadError, read_loop
from stickslip.logs.files.clock_change import repaired_clock_change
from stickslip.logs.files.order import about_sampling, ordered_times


def table(times) -> str:
    return "time [s],PV,OP\n" + "".join(f"{t},{i},{50 + i % 3}\n" for i, t in enumerate(times))


@pytest.mark.parametrize(
    "times",
    [[0, 1, 2, 2, 4, 5, 6, 6, 8, 9], [0, 1, 3, 3, 4, 5, 7, 7, 8, 9]],
    ids=["double step behind", "double step before"],
)
def test_repeated_stamps_beside_double_steps_are_evened_out(write, times):
    loop = read_loop(write(table(times)))
    assert loop.t.tolist() == list(range(10))
    assert loop.pv.tolist() == list(range(10)), "every row is kept, in its order"
    assert any("2 repeated time stamps beside double steps: evened out" in note for note in loop.notes)


@given(places=st.lists(st.integers(1, 48), unique=True), late=st.booleans())
def test_a_sample_stamped_one_step_late_or_early_is_put_back(places, late):
    stamps = np.arange(200.0)
    for place in places:
        stamps[4 * place] += 1.0 if late else -1.0
    t, keep, notes = ordered_times(stamps, list(range(200)), [np.arange(200.0)])
    assert t.tolist() == list(range(200))  # analytic: each is the only one between its neighbours
    assert len(keep) == 200 and len(notes) == (len(places) > 0)


@pytest.mark.parametrize("share", [2, 3, 4])
def test_stamps_coarser_than_the_sampling_are_spread(write, share):
    times = [f"{(i // share) * 60}" for i in range(60)]
    loop = read_loop(write(table(times)))
    assert np.allclose(loop.t, np.arange(60) * 60 / share, rtol=0, atol=1e-9)
    assert any("Time stamps are rounded to 60 s" in note for note in loop.notes)


def test_faster_than_its_stamps_by_a_little(write):
    true = 0.93 * np.arange(200)  # analytic: 7 % of the stamps come twice, never beside a double step
    loop = read_loop(write(table(np.floor(true).astype(int))))
    assert len(loop) == 200
    assert np.abs(loop.t - true).max() < 1.0
    assert loop.dt == pytest.approx(0.93, rel=1e-3)


@pytest.mark.parametrize(
    "times", [[0, 1, 1], [0, 1, 2, 3, 3, 4, 5, 6, 7, 8, 9, 10, 11], [*range(100), 99, *range(100, 140), 139]]
)
def test_two_values_at_one_time_that_rounding_does_not_explain_are_refused(write, times):
    with pytest.raises(ReadError, match="same time"):
        read_loop(write(table(times)))


def test_three_missing_rows_of_2400_are_no_uneven_sampling(write):
    times = [t for t in range(2403) if t not in (700, 1500, 1501)]
    loop = read_loop(write(table(times)))
    assert len(loop) == 2400
    assert "3 rows are missing in 2 places (1 s is the rule)." in loop.notes
    assert not any("uneven" in note for note in loop.notes)
    assert len(loop.segments()) == 1


def test_uneven_sampling_is_still_named():
    t = np.cumsum(np.random.default_rng(0).choice([1.0, 2.0, 3.0], 300))
    assert any("uneven" in note for note in about_sampling(t, guessed=False))


def test_newest_first_is_read_the_other_way_round(write):
    rows = [f"2024-06-13 21:55:{i:02d},{i},50\n" for i in range(20)]
    loop = read_loop(write("time,PV,OP\n" + "".join(reversed(rows))))
    assert loop.t.tolist() == loop.pv.tolist() == list(range(20))
    assert loop.log.start == datetime(2024, 6, 13, 21, 55)
    assert any("read the other way round" in note for note in loop.notes)


def test_newest_first_in_a_long_table(write):
    rows = [f"FIC1.PV,{i},{i}\nFIC1.OP,{i},50\n" for i in range(20)]
    assert read_loop(write("tag,time,value\n" + "".join(reversed(rows)))).pv.tolist() == list(range(20))


@pytest.mark.parametrize("stamp", ["{i}", "2024-06-13 21:{m:02d}:{s:02d}"])
def test_a_row_without_a_time_is_a_missing_row(write, stamp):
    rows = [stamp.format(i=i, m=i // 60, s=i % 60) if i != 70 else "" for i in range(200)]
    loop = read_loop(write("time,PV,OP\n" + "".join(f"{t},{i},50\n" for i, t in enumerate(rows))))
    assert loop.pv.tolist() == loop.t.tolist() == [i for i in range(200) if i != 70]
    assert "1 row has no time (first in line 72): left out." in loop.notes
    assert "1 row is missing in 1 place (1 s is the rule)." in loop.notes


def test_many_rows_without_a_time_are_refused(write):
    rows = ["" if i % 10 == 3 else str(i) for i in range(100)]
    with pytest.raises(ReadError, match="line 5 has no time"):
        read_loop(write("time,PV,OP\n" + "".join(f"{t},{i},50\n" for i, t in enumerate(rows))))


def test_a_file_in_which_every_row_stands_twice_keeps_its_sampling(tmp_path):
    # before: "stamps are rounded to 2 s", and rows 1 s apart, so that a controller of 2 s scanned every second
    rows = [f"{2 * i},{i},{50 + i % 3}\n" * 2 for i in range(60)]
    (tmp_path / "twice.csv").write_text("time [s],PV,OP\n" + "".join(rows))
    record = read_loop(tmp_path / "twice.csv")
    assert (record.dt, len(record.t)) == (2.0, 60)
    assert any("60 repeated rows dropped" in note for note in record.notes)


@pytest.mark.parametrize("hours", [2, 24])
def test_rows_hours_apart_on_a_sunday_in_september_are_no_change_of_the_clock(hours):
    start = datetime(2024, 8, 25)  # seven days before a Sunday of September, at midnight
    t = np.arange(300.0) * 3600.0 * hours
    repaired, note = repaired_clock_change(t, start)
    assert repaired.tolist() == t.tolist() and note is None
