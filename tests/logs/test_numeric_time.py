"""Times written as numbers: units by name, by size, by interval, or as told; and doubt in words."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from stickslip.logs import ReadError, read_log, read_loop

N = 30
START = datetime(2024, 6, 13, 21, 55)
UNIX, WINDOWS, LABVIEW = datetime(1970, 1, 1), datetime(1601, 1, 1), datetime(1904, 1, 1)


def table(times, head="time") -> str:
    return f"{head},PV,OP\n" + "".join(f"{t},{i % 5},{50 + i % 3}\n" for i, t in enumerate(times))


def since(origin: datetime, i: int, interval: int = 10) -> int:
    """Whole seconds from `origin` to row i: analytic, by Python's own calendar."""
    return round((START + i * timedelta(seconds=interval) - origin) / timedelta(seconds=1))


COUNTS = {
    "seconds since 1970": [since(UNIX, i) for i in range(N)],
    "milliseconds since 1970": [since(UNIX, i) * 10**3 for i in range(N)],
    "microseconds since 1970": [since(UNIX, i) * 10**6 for i in range(N)],
    "nanoseconds since 1970": [since(UNIX, i) * 10**9 for i in range(N)],
    "FILETIME": [since(WINDOWS, i) * 10**7 for i in range(N)],
    "ticks": [since(datetime(1, 1, 1), i) * 10**7 for i in range(N)],
    "since 1904": [since(LABVIEW, i) for i in range(N)],
    # Published: datenum(1970, 1, 1) is 719529.
    "datenum": [f"{719529 + since(UNIX, i) / 86400:.9f}" for i in range(N)],
    # Published: 1970-01-01 is day 25569 of the 1900 date system.
    "spreadsheet": [f"{25569 + since(UNIX, i) / 86400:.9f}" for i in range(N)],
}


@pytest.mark.parametrize("words", COUNTS)
def test_counts_since_a_date_are_known_by_their_size(write, words):
    loop = read_loop(write(table(COUNTS[words])))
    assert np.allclose(loop.t, 10.0 * np.arange(N), rtol=0, atol=2e-3)
    assert abs(loop.log.start.replace(tzinfo=None) - START) < timedelta(milliseconds=2)
    assert any(words in note for note in loop.notes)


def test_whole_counts_are_exact(write):
    # A double holds such a FILETIME to 16 counts only: 0.1 s steps would show 1.6e-6 s of rounding.
    times = [since(WINDOWS, 0) * 10**7 + i * 10**6 + 1 for i in range(N)]
    assert read_loop(write(table(times))).t.tolist() == [round(0.1 * i, 6) for i in range(N)]


INTERVALS = [  # (cells, unit they are in, interval [s])
    ([1000 * i for i in range(N)], "milliseconds", 1.0),
    ([5000 * i + i % 3 for i in range(N)], "milliseconds", 5.0),
    ([10**6 * i for i in range(N)], "microseconds", 1.0),
    ([10**9 * i for i in range(N)], "nanoseconds", 1.0),
    ([f"{i / 3600:.8f}" for i in range(N)], "hours", 1.0),
    ([f"{i / 360:.4f}" for i in range(N)], "hours", 10.0),
    ([f"{i / 6:.3f}" for i in range(N)], "minutes", 10.0),
    ([f"{i / 86400:.9f}" for i in range(N)], "days", 1.0),
    ([f"{i * 5 / 86400:.9f}" for i in range(N)], "days", 5.0),
]


@pytest.mark.parametrize(("times", "unit", "interval"), INTERVALS)
def test_an_interval_that_makes_sense_in_one_unit_only_tells_it(write, times, unit, interval):
    loop = read_loop(write(table(times)))
    assert (loop.t[-1] - loop.t[0]) / (N - 1) == pytest.approx(interval, rel=3e-3)
    note = next(note for note in loop.notes if note.startswith("Time goes up"))
    assert f"it is read as {unit}" in note and "--time-unit" in note


@pytest.mark.parametrize("interval", [0.1, 0.25, 0.5, 1, 2, 5, 7, 10, 30, 60, 300, 600, 900, 3600])
def test_what_makes_sense_in_seconds_stays_in_seconds(write, interval):
    loop = read_loop(write(table([round(interval * i, 6) for i in range(N)])))
    assert loop.dt == pytest.approx(interval)
    assert f"Time has no unit: it is read as seconds, {interval:g} s apart." in loop.notes
    assert not any("unusual" in note for note in loop.notes)


@pytest.mark.parametrize("interval", [0.02, 0.01667, 0.001, 7200, 123456])
def test_an_interval_of_no_process_is_doubted(write, interval):
    notes = read_loop(write(table([round(interval * i, 6) for i in range(N)]))).notes
    doubt = next(note for note in notes if "is unusual for a process" in note)
    assert f"A row every {interval:.4g} s" in doubt and "--time-unit" in doubt


def test_a_strange_interval_of_clock_stamps_is_no_matter_of_units(write):
    notes = read_loop(write(table([f"2024-01-01 00:00:00.{i:03d}" for i in range(N)]))).notes
    doubt = next(note for note in notes if "is unusual for a process" in note)
    assert "look at the time in the export" in doubt and "--time-unit" not in doubt


@pytest.mark.parametrize(
    ("head", "scale"),
    [
        ("time_ms", 1e-3), ("TimeMs", 1e-3), ("t_us", 1e-6), ("elapsed hours", 3600), ("Time [h]", 3600), ("t_s", 1),
        ("days", 86400), ("time (µs)", 1e-6), ("minutes", 60), ("milliseconds", 1e-3), ("time [sec]", 1),
        ("timestamp_ns", 1e-9),
    ],
)  # fmt: skip
def test_a_unit_in_the_name_is_obeyed(write, head, scale):
    assert read_loop(write(table(range(0, 7 * N, 7), head))).dt == pytest.approx(7 * scale)


@pytest.mark.parametrize(
    ("unit", "scale"),
    [("ms", 1e-3), ("msec", 1e-3), ("Hours", 3600), ("d", 86400), ("us", 1e-6), ("s", 1), ("min", 60)],
)
def test_a_told_unit_goes_before_everything(write, unit, scale):
    loop = read_loop(write(table(range(0, 7 * N, 7), "time [h]")), time_unit=unit)
    assert loop.dt == pytest.approx(7 * scale)
    assert any("Time is read in" in note for note in loop.notes), "what was taken is said"


def test_a_told_unit_may_count_from_a_date(write):
    log = read_log(write(table(COUNTS["milliseconds since 1970"])), time_unit="ms")
    assert log.start == START.replace(tzinfo=UTC)
    days = read_log(write(table(range(45456, 45456 + N))), time_unit="excel")
    assert (days.start, days.dt) == (datetime(2024, 6, 13), 86400.0)


@pytest.mark.parametrize(
    ("times", "unit", "words"),
    [
        (range(N), "fortnight", ["'fortnight'", "filetime", "ms"]),
        (range(N), "filetime", ["0 to 29", "FILETIME", "time_unit"]),
        (range(N), "datenum", ["0 to 29", "datenum"]),
        ([f"2024-01-01 00:00:{i:02d}" for i in range(N)], "ms", ["line 2", "not a number", "leave time_unit"]),
    ],
)
def test_a_told_unit_that_cannot_be_is_refused(write, times, unit, words):
    with pytest.raises(ReadError) as caught:
        read_loop(write(table(times)), time_unit=unit)
    assert all(word in str(caught.value) for word in words), str(caught.value)
